// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace couplet::dropin {

/// A mesh that the program provides: this process's vertices, and its edges or faces, which become the faces of the
/// participant's surface.
struct Mesh {
  std::string name;
  int dimensions = 3;
  std::vector<double> xyz;                       ///< 3 a vertex; 2-D: z = 0
  std::vector<std::vector<std::int64_t>> faces;  ///< edges in 2-D; triangles and quads in 3-D

  std::int64_t vertices() const { return std::int64_t(xyz.size() / 3); }
  int add(const double* position);
  /// Area vectors: of an edge (a, b) the right-hand normal times its length, of a triangle or quad that of its order.
  std::array<double, 3> centre(std::size_t face) const;
  std::array<double, 3> area(std::size_t face) const;
};

}  // namespace couplet::dropin
