// SPDX-License-Identifier: Apache-2.0
#include "common/elasticity/symmetric/prestress.hpp"

#include <Eigen/Geometry>
#include <array>

namespace couplet::elastic {
namespace {

Tensor3 cross(const Vec3& e) {
  Tensor3 m;
  m << 0, -e[2], e[1], e[2], 0, -e[0], -e[1], e[0], 0;
  return m;
}

using Places = std::array<Index, 3>;

/// (K_rs + K_sr^T) / 2 = p / 12 [e_s - e_r]x of the corners b, i, j, which turn about the outer normal.
void add_triangle(const Places& at, const std::array<Vec3, 3>& x, double p, std::vector<PlaceBlock>& to) {
  const std::array<Vec3, 3> opposite{x[2] - x[1], x[0] - x[2], x[1] - x[0]};
  for (std::size_t r = 0; r < 3; ++r)
    for (std::size_t s = 0; s < 3; ++s)
      if (r != s) to.push_back({at[r], at[s], p / 12 * cross(opposite[s] - opposite[r])});
}

}  // namespace

std::vector<PlaceBlock> pressure_stiffness(const mesh::Mesh& mesh, const mesh::Geometry& geometry,
                                           std::span<const double> pressure) {
  std::vector<PlaceBlock> blocks;
  const Index n_nodes = mesh.cells.n_local() + mesh.boundary.n_local();
  for (Index b = 0; b < Index(pressure.size()); ++b) {
    const double p = pressure[std::size_t(b)];
    if (p == 0) continue;
    const Index f = mesh.n_interior + b;
    const auto points = mesh.face_points[f];
    const Vec3 centre = geometry.face_centre[f], normal = geometry.face_area[f];
    const auto place = [&](std::size_t k) { return geometry.points[points[k % points.size()]]; };
    const Index node = mesh.cells.n_local() + b;
    if (mesh.dim == 3) {
      const bool turns = (place(0) - centre).cross(place(1) - centre).dot(normal) > 0;
      for (std::size_t k = 0; k < points.size(); ++k)
        add_triangle({node, n_nodes + points[k], n_nodes + points[(k + 1) % points.size()]},
                     {centre, place(k), place(k + 1)}, turns ? p : -p, blocks);
      continue;
    }
    // a = +-R (q - p) of the lines from the first corner to the node and on to the second.
    Tensor3 r = Tensor3::Zero();
    const Vec3 along = place(1) - place(0);
    const double turn = along[1] * normal[0] - along[0] * normal[1] > 0 ? 1 : -1;
    r(0, 1) = 1, r(1, 0) = -1;
    const std::array<Index, 3> chain{n_nodes + points[0], node, n_nodes + points[1]};
    for (std::size_t k = 0; k < 2; ++k) {
      blocks.push_back({chain[k], chain[k + 1], 0.5 * p * turn * r});
      blocks.push_back({chain[k + 1], chain[k], -0.5 * p * turn * r});
    }
  }
  return blocks;
}

}  // namespace couplet::elastic
