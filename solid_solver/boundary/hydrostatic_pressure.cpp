// SPDX-License-Identifier: Apache-2.0
#include "solid_solver/boundary/hydrostatic_pressure.hpp"

#include <Eigen/Geometry>
#include <algorithm>

namespace couplet::solid {

HydrostaticPressure::HydrostaticPressure(const mesh::Mesh& mesh, const mesh::Geometry& geometry,
                                         const TotalLoad& load, const std::string& where)
    : mesh_(&mesh), geometry_(&geometry), level_(load.level, where + ".level") {
  Vec3 gravity = Vec3::Zero();
  for (std::size_t a = 0; a < load.gravity.size(); ++a) gravity[Index(a)] = load.gravity[a];
  up_ = -gravity.normalized();
  weight_ = load.density * gravity.norm();
}

double mean_positive(double d0, double d1) {
  if (d0 > d1) std::swap(d0, d1);
  if (d1 <= 0) return 0;
  return d0 >= 0 ? 0.5 * (d0 + d1) : 0.5 * d1 * d1 / (d1 - d0);
}

double mean_positive(double d0, double d1, double d2) {
  double d[3]{d0, d1, d2};
  std::sort(d, d + 3);
  if (d[2] <= 0) return 0;
  const double all = (d[0] + d[1] + d[2]) / 3;
  if (d[0] >= 0) return all;
  // Under the corner that lies alone on its side of the surface: a similar triangle with a third of its depth as the mean.
  const auto corner = [](double alone, double a, double b) {
    return alone * alone * alone / (3 * (alone - a) * (alone - b));
  };
  return d[1] <= 0 ? corner(d[2], d[0], d[1]) : all + corner(-d[0], -d[1], -d[2]);
}

double HydrostaticPressure::mean(Index face, double level) const {
  const auto points = mesh_->face_points[face];
  const auto place = [&](std::size_t i) -> const Vec3& { return geometry_->points[points[i]]; };
  const auto depth = [&](const Vec3& x) { return level - up_.dot(x); };
  if (mesh_->dim == 2) return weight_ * mean_positive(depth(place(0)), depth(place(1)));
  if (points.size() == 3) return weight_ * mean_positive(depth(place(0)), depth(place(1)), depth(place(2)));
  // Cut by a diagonal. Areas along the mean normal, as those of the face are.
  const Vec3 n = geometry_->face_area[face].normalized();
  const auto area = [&](std::size_t b, std::size_t c) {
    return n.dot((place(b) - place(0)).cross(place(c) - place(0)));
  };
  const double first = area(1, 2), second = area(2, 3);
  return weight_ *
         (first * mean_positive(depth(place(0)), depth(place(1)), depth(place(2))) +
          second * mean_positive(depth(place(0)), depth(place(2)), depth(place(3)))) /
         (first + second);
}

}  // namespace couplet::solid
