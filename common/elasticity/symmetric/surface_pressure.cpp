// SPDX-License-Identifier: Apache-2.0
#include "common/elasticity/symmetric/surface_pressure.hpp"

#include <Eigen/Geometry>
#include <algorithm>

namespace couplet::elastic {
namespace {

/// Triangle between the node of a face and one of its edges, or in 2-D a line between node and corner.
struct Facet {
  std::array<Index, 3> at;            ///< locations
  std::array<std::size_t, 3> corner;  ///< of the face from 1; 0 for its node
  std::array<Tensor3, 3> turn;        ///< da/dx of each corner
  Vec3 area;
  std::size_t n;  ///< number of corners
};

Tensor3 cross(const Vec3& e) {
  Tensor3 m;
  m << 0, -e[2], e[1], e[2], 0, -e[0], -e[1], e[0], 0;
  return m;
}

/// Calls take(piece) for the pieces of a boundary face, with positions given by position(place).
template <class Position, class Take>
void visit_pieces(const mesh::Mesh& mesh, Index face, const Position& position, const Take& take) {
  const auto points = mesh.face_points[face];
  const Index node = mesh.cells.n_local() + face - mesh.n_interior, first_point = n_node_places(mesh);
  if (mesh.dim == 3) {
    for (std::size_t k = 0; k < points.size(); ++k) {
      const std::size_t next = (k + 1) % points.size();
      Facet piece{
          {node, first_point + points[k], first_point + points[next]}, {0, k + 1, next + 1}, {}, {}, 3};
      std::array<Vec3, 3> x;
      for (std::size_t s = 0; s < 3; ++s) x[s] = position(piece.at[s]);
      piece.area = 0.5 * (x[1] - x[0]).cross(x[2] - x[0]);
      for (std::size_t s = 0; s < 3; ++s) piece.turn[s] = 0.5 * cross(x[(s + 2) % 3] - x[(s + 1) % 3]);
      take(piece);
    }
    return;
  }
  Tensor3 right = Tensor3::Zero();
  right(0, 1) = 1, right(1, 0) = -1;
  const auto half = [&](Index from, Index to, std::size_t first, std::size_t second) {
    take(Facet{{from, to, -1},
               {first, second, 0},
               {Tensor3(-right), right, {}},
               right * (position(to) - position(from)),
               2});
  };
  half(first_point + points[0], node, 1, 0);
  half(node, first_point + points[1], 0, 2);
}

void add_blocks_of(const Facet& piece, const std::array<double, 5>& pressure, std::vector<PlaceBlock>& to) {
  for (std::size_t r = 0; r < piece.n; ++r)
    for (std::size_t s = 0; s < piece.n; ++s)
      to.push_back({piece.at[r], piece.at[s], pressure[piece.corner[r]] / double(piece.n) * piece.turn[s]});
}

Vec3 position(const mesh::Mesh& mesh, const mesh::Geometry& geometry, Index place) {
  const Index point = place - n_node_places(mesh);
  return point >= 0 ? geometry.points[point]
                    : geometry.face_centre[mesh.n_interior + place - mesh.cells.n_local()];
}

}  // namespace

void add_blocks(SymmetricSpace& space, std::span<const PlaceBlock> blocks, double factor) {
  for (const PlaceBlock& b : blocks) space.force(b.i) += factor * (b.block * space.value(b.j));
}

void FollowerPressure::set(const mesh::Mesh& mesh, const mesh::Geometry& geometry,
                           std::span<const double> pressure) {
  faces_.clear();
  tangent_.clear();
  const std::size_t n = std::size_t(mesh.boundary.n_owned()), n_places = mesh.dim == 2 ? 3 : 5;
  for (std::size_t i = 0; i < n; ++i) {
    std::array<double, 5> here;
    here.fill(pressure.empty() ? 0 : pressure[i]);
    if (pressure.size() > n) std::ranges::copy(pressure.subspan(n + i * n_places, n_places), here.begin());
    if (std::ranges::all_of(here, [](double p) { return p == 0; })) continue;
    const Index f = mesh.n_interior + Index(i);
    Vec3 area = Vec3::Zero();
    visit_pieces(
        mesh, f, [&](Index place) { return position(mesh, geometry, place); },
        [&](const Facet& piece) { area += piece.area; });
    if (area.dot(geometry.face_area[f]) < 0)
      for (double& p : here) p = -p;
    faces_.push_back({f, here});
  }
}

Vec3 FollowerPressure::add_forces(SymmetricSpace& space) {
  Vec3 total = Vec3::Zero();
  tangent_.clear();
  const auto now = [&](Index place) {
    return Vec3(position(space.mesh(), space.rows().geometry(), place) + space.value(place));
  };
  for (const Loaded& loaded : faces_)
    visit_pieces(space.mesh(), loaded.face, now, [&](const Facet& piece) {
      for (std::size_t s = 0; s < piece.n; ++s) {
        const Vec3 inner = loaded.pressure[piece.corner[s]] * piece.area / double(piece.n);
        total -= inner;
        space.force(piece.at[s]) += inner;
      }
      add_blocks_of(piece, loaded.pressure, tangent_);
    });
  return total;
}

std::vector<PlaceBlock> pressure_stiffness(const mesh::Mesh& mesh, const mesh::Geometry& geometry,
                                           std::span<const double> pressure) {
  FollowerPressure follower;
  follower.set(mesh, geometry, pressure);
  std::vector<PlaceBlock> whole, blocks;
  for (const auto& [face, p] : follower.loaded())
    visit_pieces(
        mesh, face, [&](Index place) { return position(mesh, geometry, place); },
        [&](const Facet& piece) { add_blocks_of(piece, p, whole); });
  for (const PlaceBlock& b : whole) {
    blocks.push_back({b.i, b.j, 0.5 * b.block});
    blocks.push_back({b.j, b.i, 0.5 * b.block.transpose()});
  }
  return blocks;
}

}  // namespace couplet::elastic
