// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <mpi.h>

#include <span>
#include <vector>

#include "common/mesh/mesh.hpp"

namespace couplet::mesh {

/// Undirected graph of `n` nodes from edges (first[i], second[i]). The neighbors of a node are ascending.
Csr make_graph(Index n, std::span<const Index> first, std::span<const Index> second);

/// Partitions a graph into parts 0 .. parts - 1 by PT-Scotch. Each rank holds the rows of some nodes, those
/// of rank 0 first; `neighbours` are global numbers. A graph that is entirely on one rank is partitioned
/// there. The result is reproducible. Collective.
std::vector<int> partition(MPI_Comm comm, std::span<const Index> offset,
                           std::span<const GlobalIndex> neighbours, int parts);

/// Reverse Cuthill-McKee order: order[i] is the i-th node. Components follow one another.
std::vector<Index> reverse_cuthill_mckee(const Csr& graph);

}  // namespace couplet::mesh
