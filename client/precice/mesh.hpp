// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace couplet::dropin {

/// Mesh that the program provides: this process's vertices, and edges or faces that become the faces of the
/// participant's surface.
struct Mesh {
  std::string name;
  int dimensions = 3;
  std::vector<double> xyz;                       ///< 3 per vertex; 2-D: z = 0
  std::vector<std::vector<std::int64_t>> faces;  ///< edges in 2-D; triangles and quads in 3-D

  std::int64_t vertices() const { return std::int64_t(xyz.size() / 3); }
  int add(const double* position);
  /// Center and area vector of a face. For an edge (a, b) that is the right-hand normal times its length.
  std::array<double, 3> centre(std::size_t face) const;
  std::array<double, 3> area(std::size_t face) const;
};

}  // namespace couplet::dropin
