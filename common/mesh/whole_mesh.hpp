// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "common/mesh/load.hpp"
#include "common/mesh/topology.hpp"
#include "common/parallel/index_map.hpp"

namespace couplet::mesh {

/// The whole mesh with its faces and its partition, the same on all ranks while the local parts are cut out; or the piece
/// of it that holds the cells of this rank and all that are near them, with numbers of its own.
struct WholeMesh {
  RawMesh raw;
  Faces faces;
  std::vector<int> part;           // rank of each cell
  std::vector<int> cell_material;  // empty: one material
  std::vector<Index> wide_points;
  // Of a piece: numbers in the mesh, ascending, and the ranks that own the points. Empty: the mesh is whole.
  std::vector<GlobalIndex> cell_number, point_number;
  std::vector<int> point_owner;
};

/// Cuts this rank's part out; `whole` is gone before the geometry is made. Collective.
LoadedMesh cut_part(MPI_Comm comm, WholeMesh&& whole);

/// Collective; `raw` is read on rank 0.
WholeMesh make_whole_mesh(MPI_Comm comm, const RawMesh& raw);

/// Index map of entries known by `ids` (owned ones first); the owners tell where they keep what is a ghost here. Collective.
parallel::IndexMap make_index_map(MPI_Comm comm, std::span<const GlobalIndex> ids, Index n_owned,
                                  const std::vector<int>& ghost_owner);

}  // namespace couplet::mesh
