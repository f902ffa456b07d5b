// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <mpi.h>

#include <array>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "common/mesh/distributed/cell_list.hpp"
#include "common/mesh/load.hpp"

namespace couplet::mesh {

/// This rank's block of a mesh, as a file or a generator gives it: its share of the points and of the cells by their
/// numbers, and some boundary elements, those of rank 0 first. A small mesh is a block of rank 0 with empty ones beside it; of
/// a large one no rank has the whole.
struct MeshBlock {
  int dim = 3;
  Shares point_shares, cell_shares;
  std::vector<Vec3> points;  ///< of this rank's share
  CellList cells;            ///< of this rank's share; without `id`
  std::vector<GlobalIndex> element_points;
  std::vector<Index> element_offset{0};
  std::vector<int> element_patch;
  // These agree on all ranks, as in RawMesh:
  std::vector<std::string> zones, patches;
  std::vector<std::array<std::string, 2>> periodic;
  std::vector<std::vector<std::string>> materials;
  bool find_wide_points = true;

  Index n_elements() const { return static_cast<Index>(element_patch.size()); }
  std::span<const GlobalIndex> element(Index e) const {
    return {element_points.data() + element_offset[e],
            std::size_t(element_offset[e + 1] - element_offset[e])};
  }
  void push_cell(CellType type, int zone, std::span<const GlobalIndex> cell_points);
  void push_element(int patch, std::span<const GlobalIndex> points_of_element);
};

/// This rank's block of a mesh that the first `holders` ranks share out evenly, each of which has it as a whole. `raw` is
/// that of rank 0 elsewhere only in `periodic`, `materials` and `find_wide_points`. Collective.
MeshBlock block_of(MPI_Comm comm, const RawMesh& raw, int holders = 1);

/// The same mesh as one piece, of a block that is all of it.
RawMesh raw_of(MeshBlock block);

/// Takes out the points that no cell and no boundary element has (a .msh may carry centers of circles); the order of the others
/// stays, and they are shared out anew. Collective.
void drop_unused_points(MPI_Comm comm, MeshBlock& block);

/// From blocks to this rank's part: faces are matched, cells shared out by PT-Scotch and sent to their ranks, and what
/// surrounds them fetched, all in parallel: no rank holds more than its block and its part with its surroundings.
/// `part`: the rank of each cell of the block, in place of PT-Scotch's. Every boundary face must belong to exactly one patch;
/// errors name the place. Collective.
LoadedMesh distribute(MPI_Comm comm, MeshBlock block, std::span<const int> part = {});

/// The same of a block of this file, all lengths times `scale`, checked and reported. Throws Error with the name of the
/// file. Collective.
LoadedMesh load_block(MPI_Comm comm, MeshBlock block, const std::filesystem::path& file, double scale);

}  // namespace couplet::mesh
