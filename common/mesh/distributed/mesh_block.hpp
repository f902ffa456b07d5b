// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <mpi.h>

#include <array>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "common/mesh/distributed/cell_list.hpp"
#include "common/mesh/distributed/shares.hpp"
#include "common/mesh/load.hpp"

namespace couplet::mesh {

/// This rank's block of a mesh of which no rank has the whole, as a file or a generator gives it: an even share of the
/// points and of the cells by their numbers, and some boundary elements, those of rank 0 first.
struct MeshBlock {
  int dim = 3;
  Shares point_shares, cell_shares;
  std::vector<Vec3> points;  ///< of this rank's share
  CellList cells;            ///< of this rank's share; without `id`
  std::vector<GlobalIndex> element_points;
  std::vector<Index> element_offset{0};
  std::vector<int> element_patch;
  // The same on all ranks, as in RawMesh.
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

/// The block of this rank of a mesh that every rank has as a whole.
MeshBlock block_of(MPI_Comm comm, RawMesh raw);

/// From blocks to this rank's part: faces are matched, cells shared out by PT-Scotch and sent to their ranks, and what
/// surrounds them fetched, all in parallel: no rank ever holds more than its block and its part with its surroundings.
/// The parts are those that distribute() would give if it shared the cells out in the same way. `part`: the rank of each
/// cell of the block, in place of PT-Scotch's. Collective.
LoadedMesh distribute(MPI_Comm comm, MeshBlock block, std::span<const int> part = {});

/// The same of a block of this file, all lengths times `scale`, checked and reported as load_mesh() does. Collective.
LoadedMesh load_block(MPI_Comm comm, MeshBlock block, const std::filesystem::path& file, double scale);

}  // namespace couplet::mesh
