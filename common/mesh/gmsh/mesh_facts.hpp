// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

#include "common/mesh/load.hpp"

namespace couplet::mesh {

/// What estimates before a run look at.
struct MeshFacts {
  int dim = 3;               ///< 2: cells in the plane only
  Vec3 size = Vec3::Zero();  ///< of the box around the points [m]
  double shortest_edge = 0;  ///< of any cell [m]
  double mean_cell = 0;      ///< (volume of the box over the number of cells)^(1/dim) [m]
  std::size_t cells = 0;
  double smallest_side() const;  ///< of the box, in the directions that the mesh has [m]
  double largest_side() const;
};
MeshFacts facts_of(const RawMesh& raw);

/// Of a .msh or .geo (meshed, with its cache), its lengths times `scale`: in three dimensions if it names a physical
/// volume. Throws Error.
MeshFacts facts_of_file(const std::filesystem::path& file, const MeshParameters& parameters, double scale);

}  // namespace couplet::mesh
