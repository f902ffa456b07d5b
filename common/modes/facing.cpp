// SPDX-License-Identifier: Apache-2.0
#include "common/modes/facing.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <utility>

namespace couplet {
namespace {

/// A surface whose area vectors add up to more than this share of its area is a sheet: those of a closed one cancel,
/// of a plate they leave the missing rim, of half of a tube 0.64.
constexpr double sheet_share = 0.25;

/// The middle of the edges that one face alone has; none: the surface is closed.
std::optional<Vec3> middle_of_rim(const ModalModel& model) {
  std::map<std::pair<Index, Index>, int> uses;
  for (Index f = 0; f < model.faces.size(); ++f) {
    const auto corners = model.faces[f];
    for (std::size_t i = 0; i < corners.size(); ++i)
      ++uses[std::minmax(corners[i], corners[(i + 1) % corners.size()])];
  }
  Vec3 sum = Vec3::Zero();
  double length = 0;
  for (const auto& [edge, n] : uses) {
    if (n > 1) continue;
    const Vec3 &a = model.vertices[edge.first], &b = model.vertices[edge.second];
    sum += (b - a).norm() * 0.5 * (a + b);
    length += (b - a).norm();
  }
  if (!(length > 0)) return std::nullopt;
  return sum / length;
}

}  // namespace

std::optional<double> volume_behind(const ModalModel& model) {
  const std::vector<Vec3> centres = face_centres(model), areas = face_areas(model);
  Vec3 left = Vec3::Zero(), middle = Vec3::Zero();
  double area = 0;
  for (std::size_t f = 0; f < areas.size(); ++f) {
    left += areas[f];
    area += areas[f].norm();
    middle += areas[f].norm() * centres[f];
  }
  if (!(area > 0) || left.norm() > sheet_share * area) return std::nullopt;
  middle /= area;
  const auto about = [&](const Vec3& origin) {
    double volume = 0;
    for (std::size_t f = 0; f < areas.size(); ++f) volume += (centres[f] - origin).dot(areas[f]) / 3;
    return volume;
  };
  const std::optional<Vec3> rim = middle_of_rim(model);
  if (!rim) return about(middle);
  // Where the rim is wide and bent the cone is a guess: what the surface's own middle sees must have the same sign.
  const double by_rim = about(*rim), by_middle = about(middle);
  if ((by_rim > 0) != (by_middle > 0)) return std::nullopt;
  return by_rim;
}

std::string facing_problem_of(const ModalModel& model) {
  const std::optional<double> volume = volume_behind(model);
  if (!volume || !(*volume < 0)) return "";
  return fmt::format(
      "its faces are turned inside out: their normals point into the {:.3g} m^3 that the surface encloses, and those of a "
      "body point out of it (vertices of a face turn right-handed about the outward normal)",
      -*volume);
}

}  // namespace couplet
