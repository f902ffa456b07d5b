// SPDX-License-Identifier: Apache-2.0
#include <Eigen/Dense>
#include <algorithm>

#include "common/mesh/topology.hpp"
#include "common/mesh/transpose.hpp"

namespace couplet::mesh {
namespace {

Vec3 mean(const RawMesh& raw, std::span<const Index> points) {
  Vec3 x = Vec3::Zero();
  for (const Index p : points) x += raw.points[p];
  return x / double(points.size());
}

/// The least weights are those of the least-squares plane through the nodes, n sum w_i^2 = n e^T N^-1 e with
/// its normal matrix N = sum (1, r_i) (1, r_i)^T: the inverse of 1 - s^T M^-1 s / n.
double reach(const std::vector<Vec3>& nodes, const Vec3& point, int dim) {
  Tensor3 m = Tensor3::Zero();
  Vec3 s = Vec3::Zero();
  for (const Vec3& x : nodes) {
    const Vec3 r = point - x;
    m += r * r.transpose();
    s += r;
  }
  if (dim == 2) m(2, 2) = m.trace();
  const double rest = 1 - s.dot(m.fullPivLu().solve(s)) / double(nodes.size());
  return 1 / std::max(rest, 1e-12);
}

}  // namespace

std::vector<Index> wide_points(const RawMesh& raw, const Faces& faces,
                               const std::vector<int>& cell_material) {
  const auto n_points = static_cast<Index>(raw.points.size());
  const Csr faces_of_point = transpose(faces.points, faces.n_interior, n_points);
  const Csr cells_of_point = transpose(raw.cell_points, 0, n_points);
  const auto material = [&](Index c) { return cell_material.empty() ? 0 : cell_material[c]; };
  std::vector<Index> result;
  std::vector<Vec3> nodes;
  std::vector<int> materials;
  for (Index p = 0; p < n_points; ++p) {
    const auto open = faces_of_point[p];
    if (open.empty()) continue;
    materials.clear();
    for (const Index c : cells_of_point[p])
      if (std::ranges::find(materials, material(c)) == materials.end()) materials.push_back(material(c));
    for (const int here : materials) {
      nodes.clear();
      for (const Index c : cells_of_point[p])
        if (material(c) == here) nodes.push_back(mean(raw, raw.cell_points[c]));
      for (const Index b : open)
        if (material(faces.owner[faces.n_interior + b]) == here)
          nodes.push_back(mean(raw, faces.points[faces.n_interior + b]));
      if (reach(nodes, raw.points[p], raw.dim) <= longest_reach) continue;
      result.push_back(p);
      break;
    }
  }
  return result;
}

}  // namespace couplet::mesh
