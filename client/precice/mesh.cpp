// SPDX-License-Identifier: Apache-2.0
#include "mesh.hpp"

namespace couplet::dropin {

int Mesh::add(const double* position) {
  for (int d = 0; d < 3; ++d) xyz.push_back(d < dimensions ? position[d] : 0);
  return int(vertices()) - 1;
}

std::array<double, 3> Mesh::centre(std::size_t face) const {
  std::array<double, 3> mean{};
  for (const std::int64_t v : faces[face])
    for (std::size_t d = 0; d < 3; ++d) mean[d] += xyz[3 * std::size_t(v) + d] / double(faces[face].size());
  return mean;
}

std::array<double, 3> Mesh::area(std::size_t face) const {
  const auto& corners = faces[face];
  const auto point = [&](std::size_t k) { return &xyz[3 * std::size_t(corners[k])]; };
  if (corners.size() == 2) return {point(1)[1] - point(0)[1], point(0)[0] - point(1)[0], 0};
  std::array<double, 3> sum{};
  for (std::size_t k = 1; k + 1 < corners.size(); ++k) {  // fan of triangles
    double a[3], b[3];
    for (int d = 0; d < 3; ++d) a[d] = point(k)[d] - point(0)[d], b[d] = point(k + 1)[d] - point(0)[d];
    sum[0] += (a[1] * b[2] - a[2] * b[1]) / 2;
    sum[1] += (a[2] * b[0] - a[0] * b[2]) / 2;
    sum[2] += (a[0] * b[1] - a[1] * b[0]) / 2;
  }
  return sum;
}

}  // namespace couplet::dropin
