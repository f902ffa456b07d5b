// SPDX-License-Identifier: Apache-2.0
// Tractions of boundary faces: those of the loads where they are known, else of the stress at the faces' points.
#include <Eigen/Geometry>

#include "solid_solver/body/solid_fields.hpp"

namespace couplet::solid {
namespace {

/// Unit normal of a boundary face whose points are at `places`, out of the body as the reference one is.
Vec3 normal_at(const mesh::Mesh& mesh, const mesh::Geometry& geometry, Index face,
               std::span<const Vec3> places) {
  const auto corners = mesh.face_points[face];
  if (corners.size() == 2) {
    const auto turned = [&](std::span<const Vec3> x) {
      const Vec3 along = x[corners[1]] - x[corners[0]];
      return Vec3(along.y(), -along.x(), 0);
    };
    const double side = turned(geometry.points).dot(geometry.face_area[face]) > 0 ? 1 : -1;
    return side * turned(places).normalized();
  }
  Vec3 area = Vec3::Zero();
  for (std::size_t i = 1; i + 1 < corners.size(); ++i)
    area += (places[corners[i]] - places[corners[0]]).cross(places[corners[i + 1]] - places[corners[0]]);
  return area.normalized();
}

Tensor3 mean_stress(std::span<const Index> corners, std::span<const double> point_stress) {
  Tensor3 mean = Tensor3::Zero();
  for (const Index v : corners)
    mean += unpack(point_stress.subspan(std::size_t(v) * tensor_size, tensor_size));
  return mean / double(corners.size());
}

}  // namespace

std::vector<double> SolidFields::traction(std::span<const Vec3> places,
                                          std::span<const double> point_stress) const {
  const std::size_t n = mesh_.boundary.n_owned(), dim = mesh_.dim;
  const std::span<const Vec3> moved = body_.equilibrium().surface(places);
  const std::vector<SurfaceTraction> known =
      moved.empty() ? known_tractions() : std::vector<SurfaceTraction>(n);
  std::vector<double> result(n * dim);
  for (std::size_t b = 0; b < n; ++b) {
    const Index f = mesh_.n_interior + Index(b);
    const Vec3 normal =
        moved.empty() ? geometry_.face_area[f].normalized() : normal_at(mesh_, geometry_, f, moved);
    const Vec3 here = mean_stress(mesh_.face_points[f], point_stress) * normal;
    const Vec3 value = known[b].traction + here - known[b].projector * here;
    for (std::size_t a = 0; a < dim; ++a) result[b * dim + a] = value[Index(a)];
  }
  return result;
}

}  // namespace couplet::solid
