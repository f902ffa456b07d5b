// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <mpi.h>

#include <span>
#include <vector>

#include "common/mesh/mesh.hpp"

namespace couplet::mesh {

/// Undirected graph of `n` nodes from its edges (first[i], second[i]): per node its neighbours, ascending.
Csr make_graph(Index n, std::span<const Index> first, std::span<const Index> second);

/// A part 0 .. parts - 1 for each node of a graph, by PT-Scotch. Each rank has the rows of some nodes, those of
/// rank 0 first; `neighbours` are numbers over all ranks. A graph that is all on one rank is partitioned there. The same in every
/// run and in every call. Collective.
std::vector<int> partition(MPI_Comm comm, std::span<const Index> offset,
                           std::span<const GlobalIndex> neighbours, int parts);

/// Reverse Cuthill-McKee: order[i] is the node that comes i-th. Components one after the other.
std::vector<Index> reverse_cuthill_mckee(const Csr& graph);

}  // namespace couplet::mesh
