// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "common/mesh/load.hpp"
#include "common/mesh/topology.hpp"
#include "common/parallel/index_map.hpp"

namespace couplet::mesh {

/// The whole mesh with its faces and its partition; the same on all ranks while the local parts are cut out.
struct WholeMesh {
  RawMesh raw;
  Faces faces;
  std::vector<int> part;           // rank of each cell
  std::vector<int> cell_material;  // empty: one material
  std::vector<Index> wide_points;
};

/// Collective; `raw` is read on rank 0.
WholeMesh make_whole_mesh(MPI_Comm comm, const RawMesh& raw);

/// Index map of entries known by `ids` (owned ones first); the owners tell where they keep what is a ghost here. Collective.
parallel::IndexMap make_index_map(MPI_Comm comm, std::span<const GlobalIndex> ids, Index n_owned,
                                  const std::vector<int>& ghost_owner);

}  // namespace couplet::mesh
