// SPDX-License-Identifier: Apache-2.0
#include "common/elasticity/finite/follower_pressure.hpp"

#include <Eigen/Geometry>

namespace couplet::elastic {
namespace {

/// Area vector of the piece from corner i on: half the cross product, in 2-D the line turned by a right angle.
template <int D>
Vec3 area(const Vec3& b, const Vec3& p, const Vec3& q) {
  if constexpr (D == 3) return 0.5 * (p - b).cross(q - b);
  const Vec3 along = q - p;
  return {along[1], -along[0], 0};
}

template <int D>
int pieces(std::size_t corners) {
  return D == 3 ? int(corners) : 2;
}

/// The corners of a piece, 0 being the face's node: in the plane from the first corner to the node and on.
template <int D>
std::array<int, 3> corners_of(int piece, std::size_t corners) {
  if constexpr (D == 3) return {0, 1 + piece, 1 + (piece + 1) % int(corners)};
  return piece == 0 ? std::array<int, 3>{0, 1, 0} : std::array<int, 3>{0, 0, 2};
}

}  // namespace

template <int D>
void FollowerPressure<D>::set(const mesh::Mesh& mesh, const mesh::Geometry& geometry,
                              std::span<const double> pressure) {
  faces_.clear();
  for (std::size_t i = 0; i < pressure.size(); ++i) {
    if (pressure[i] == 0) continue;
    const Index f = mesh.n_interior + Index(i);
    Loaded loaded{f, pressure[i], 1, {}};
    loaded.place[0] = geometry.face_centre[f];
    const auto points = mesh.face_points[f];
    for (std::size_t k = 0; k < points.size(); ++k) loaded.place[k + 1] = geometry.points[points[k]];
    Vec3 sum = Vec3::Zero();
    for (int t = 0; t < pieces<D>(points.size()); ++t) {
      const auto c = corners_of<D>(t, points.size());
      sum += area<D>(loaded.place[c[0]], loaded.place[c[1]], loaded.place[c[2]]);
    }
    if (sum.dot(geometry.face_area[f]) < 0) loaded.orientation = -1;
    faces_.push_back(loaded);
  }
}

template <int D>
void FollowerPressure<D>::gather(const SymmetricSpace<D>& space, const Loaded& loaded, bool is_place,
                                 std::array<Vec3, 5>& to) const {
  constexpr int stride = SymmetricSpace<D>::stride;
  const auto read = [&](const double* at, const Vec3& reference) {
    Vec3 v = is_place ? reference : Vec3(Vec3::Zero());
    for (int a = 0; a < D; ++a) v[a] += at[a];
    return v;
  };
  const mesh::Mesh& mesh = space.mesh();
  const mesh::Geometry& geometry = space.rows().geometry();
  to[0] = read(space.nodes() + std::size_t(space.node_of_face(loaded.face)) * stride,
               geometry.face_centre[loaded.face]);
  const auto points = mesh.face_points[loaded.face];
  for (std::size_t k = 0; k < points.size(); ++k)
    to[k + 1] = read(space.points() + std::size_t(points[k]) * stride, geometry.points[points[k]]);
}

template <int D>
void FollowerPressure<D>::spread(SymmetricSpace<D>& space, const Loaded& loaded,
                                 const std::array<Vec3, 5>& forces) const {
  constexpr int stride = SymmetricSpace<D>::stride;
  const auto points = space.mesh().face_points[loaded.face];
  for (int a = 0; a < D; ++a) {
    space.forces()[std::size_t(space.node_of_face(loaded.face)) * stride + a] += forces[0][a];
    for (std::size_t k = 0; k < points.size(); ++k)
      space.point_forces()[std::size_t(points[k]) * stride + a] += forces[k + 1][a];
  }
}

template <int D>
Vec3 FollowerPressure<D>::add_forces(SymmetricSpace<D>& space, double sign) {
  Vec3 total = Vec3::Zero();
  for (Loaded& loaded : faces_) {
    gather(space, loaded, true, loaded.place);
    const std::size_t n = space.mesh().face_points[loaded.face].size();
    std::array<Vec3, 5> forces;
    forces.fill(Vec3::Zero());
    for (int t = 0; t < pieces<D>(n); ++t) {
      const auto c = corners_of<D>(t, n);
      const Vec3 here = -loaded.pressure * loaded.orientation *
                        area<D>(loaded.place[c[0]], loaded.place[c[1]], loaded.place[c[2]]);
      total += here;
      if constexpr (D == 3)
        for (const int k : c) forces[k] -= sign / 3 * here;
      else
        for (const int k : {c[1], c[2]}) forces[k] -= sign / 2 * here;
    }
    spread(space, loaded, forces);
  }
  return total;
}

template <int D>
void FollowerPressure<D>::add_tangent(SymmetricSpace<D>& space, double sign) const {
  for (const Loaded& loaded : faces_) {
    std::array<Vec3, 5> v;
    gather(space, loaded, false, v);
    const auto& x = loaded.place;
    const std::size_t n = space.mesh().face_points[loaded.face].size();
    std::array<Vec3, 5> forces;
    forces.fill(Vec3::Zero());
    for (int t = 0; t < pieces<D>(n); ++t) {
      const auto [b, p, q] = corners_of<D>(t, n);
      Vec3 change;
      if constexpr (D == 3)
        change = 0.5 * ((v[p] - v[b]).cross(x[q] - x[b]) + (x[p] - x[b]).cross(v[q] - v[b]));
      else
        change = area<D>(v[b], v[p], v[q]);
      const Vec3 here = -loaded.pressure * loaded.orientation * change;
      if constexpr (D == 3)
        for (const int k : {b, p, q}) forces[k] -= sign / 3 * here;
      else
        for (const int k : {p, q}) forces[k] -= sign / 2 * here;
    }
    spread(space, loaded, forces);
  }
}

template class FollowerPressure<2>;
template class FollowerPressure<3>;

}  // namespace couplet::elastic
