// SPDX-License-Identifier: Apache-2.0
#include "mesh_mover/measures.hpp"

#include <fmt/format.h>
#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <utility>

#include "common/mesh/quality.hpp"
#include "common/parallel/collective.hpp"

namespace couplet::mesh_mover {

const std::array<const char*, MeshState::n_measures> measure_names{
    "least volume ratio [1]", "least scaled Jacobian [1]", "largest edge ratio [1]",
    "largest angle [degree]", "largest f_A [1]",           "largest f_AR [1]"};

namespace {

bool least_is_worst(int measure) {
  return measure == MeshState::volume_ratio || measure == MeshState::scaled_jacobian;
}

/// Extreme value over all ranks; ties go to the lowest cell number. Collective.
void reduce(MPI_Comm comm, int measure, Worst& worst, bool any_here) {
  struct ExtremeCell {
    double value, number;
    double x, y, z;
  };
  const double none = least_is_worst(measure) ? std::numeric_limits<double>::infinity() : -1;
  const ExtremeCell here{any_here ? worst.value : none, static_cast<double>(worst.cell), worst.place.x(),
                         worst.place.y(), worst.place.z()};
  const std::vector<ExtremeCell> all = parallel::all_gather(comm, std::vector<ExtremeCell>{here});
  const ExtremeCell& best = *std::ranges::min_element(all, [&](const ExtremeCell& a, const ExtremeCell& b) {
    if (a.value != b.value) return least_is_worst(measure) ? a.value < b.value : a.value > b.value;
    return a.number < b.number;
  });
  worst = {best.value, static_cast<GlobalIndex>(best.number), Vec3(best.x, best.y, best.z)};
}

}  // namespace

CellMeasures::CellMeasures(const mesh::Mesh& mesh, const mesh::Geometry& geometry,
                           const Parameters& parameters)
    : mesh_(mesh), geometry_(geometry), limits_(parameters.guard) {
  for (Index c = 0; c < mesh.cells.n_owned(); ++c) longest_.push_back(shape(c, geometry.points).longest);
}

CellMeasures::Shape CellMeasures::shape(Index cell, std::span<const Vec3> points) const {
  const CellCorners& kind = corners_of(mesh_.cell_type[cell]);
  const auto corner = mesh_.cell_points[cell];
  Shape s{0, std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity()};
  for (const auto& [a, b] : kind.edges) {
    const double length = (points[corner[b]] - points[corner[a]]).norm();
    s.longest = std::max(s.longest, length);
    s.shortest = std::min(s.shortest, length);
  }
  for (const CellCorner& k : kind.corners) {
    const Vec3& x = points[corner[k[0]]];
    const Vec3 a = points[corner[k[1]]] - x, b = points[corner[k[2]]] - x;
    double jacobian = 0;
    if (mesh_.dim == 2) {
      const double size = a.norm() * b.norm();
      jacobian = size > 0 ? (a.x() * b.y() - a.y() * b.x()) / size : -1;
    } else {
      const Vec3 c = points[corner[k[3]]] - x;
      const double size = a.norm() * b.norm() * c.norm();
      jacobian = size > 0 ? a.cross(b).dot(c) / size : -1;
    }
    s.jacobian = std::min(s.jacobian, kind.scale * jacobian);
  }
  return s;
}

double CellMeasures::value(MeshState::Measure measure, Index cell, const mesh::Geometry& moved,
                           const Shape& s) const {
  const double ratio = moved.volume[cell] / geometry_.volume[cell];
  const auto log2 = [](double x) {
    return x > 0 ? std::abs(std::log2(x)) : std::numeric_limits<double>::infinity();
  };
  switch (measure) {
    case MeshState::volume_ratio:
      return ratio;
    case MeshState::scaled_jacobian:
      return s.jacobian;
    case MeshState::edge_ratio:
      return s.longest / s.shortest;
    case MeshState::area_change:
      return log2(ratio);
    case MeshState::shape_change:
      return log2(std::pow(s.longest / longest_[cell], mesh_.dim) / std::abs(ratio));
    default:
      return 0;
  }
}

std::vector<double> CellMeasures::of_cells(MeshState::Measure measure, const mesh::Geometry& moved) const {
  std::vector<double> values(mesh_.cells.n_local(), 0.0);
  for (Index c = 0; c < mesh_.cells.n_owned(); ++c)
    values[c] = value(measure, c, moved, shape(c, moved.points));
  return values;
}

double CellMeasures::largest_angle(const mesh::Geometry& moved, Index& cell) const {
  double least = 2;
  for (Index f = 0; f < mesh_.n_interior; ++f) {
    const Index p = mesh_.owner[f], n = mesh_.neighbour[f];
    const Vec3 line = moved.cell_centre[n] + mesh_.shift(f) - moved.cell_centre[p];
    const double cosine =
        line.dot(moved.face_area[f]) / std::max(line.norm() * moved.face_area[f].norm(), 1e-300);
    if (cosine >= least) continue;
    least = cosine;
    cell = p < mesh_.cells.n_owned() ? p : n;
  }
  return std::acos(std::clamp(least, -1.0, 1.0)) * 180 / std::numbers::pi;
}

MeshState CellMeasures::measure(const mesh::Geometry& moved) const {
  MeshState state;
  std::array<Index, MeshState::n_measures> cell{};
  const bool any_here = mesh_.cells.n_owned() > 0;
  for (Index c = 0; c < mesh_.cells.n_owned(); ++c) {
    const Shape s = shape(c, moved.points);
    for (int m = 0; m < MeshState::n_measures; ++m) {
      if (m == MeshState::angle) continue;
      const double v = value(MeshState::Measure(m), c, moved, s);
      Worst& worst = state.worst[m];
      if (c > 0 && (least_is_worst(m) ? v >= worst.value : v <= worst.value)) continue;
      worst.value = v;
      cell[m] = c;
    }
  }
  state.worst[MeshState::angle].value = largest_angle(moved, cell[MeshState::angle]);
  for (int m = 0; m < MeshState::n_measures; ++m) {
    Worst& worst = state.worst[m];
    if (any_here) {
      worst.cell = mesh_.cell_id[cell[m]];
      worst.place = moved.cell_centre[cell[m]];
    }
    reduce(mesh_.comm, m, worst, any_here);
  }
  return state;
}

std::string CellMeasures::refusal(const mesh::Geometry& moved, bool by_corners) const {
  const auto at = [](const Vec3& x) { return fmt::format("({:.6g}, {:.6g}, {:.6g})", x.x(), x.y(), x.z()); };
  if (const auto trouble = mesh::find_inverted(mesh_, moved))
    return fmt::format(
        "inverts cell {} at {} (volume {:.3e} m^3). Try more stiffening or a coarser mesh there.",
        trouble->cell_id, at(trouble->centre), trouble->volume);
  if (const auto trouble = mesh::find_crossed(mesh_, moved))
    return fmt::format("makes cell {} at {} intersect itself. Try more stiffening or a coarser mesh there.",
                       trouble->cell_id, at(trouble->centre));
  if (!limits_.checks_shape() && !by_corners) return "";
  const MeshState state = measure(moved);
  const auto beyond = [&](MeshState::Measure measure, double limit, const char* key) {
    const Worst& worst = state.worst[measure];
    if (least_is_worst(measure) ? worst.value >= limit : worst.value <= limit) return std::string();
    return fmt::format("leaves cell {} at {} with a {} of {:.3g} (guard.{} is {:.3g}).", worst.cell,
                       at(worst.place), measure_names[measure], worst.value, key, limit);
  };
  const double least_jacobian = std::max(limits_.smallest_scaled_jacobian, by_corners ? 0. : -1.);
  const std::string refused = beyond(MeshState::scaled_jacobian, least_jacobian, "smallest-scaled-jacobian");
  return !refused.empty() || !limits_.largest_angle
             ? refused
             : beyond(MeshState::angle, *limits_.largest_angle, "largest-angle");
}

const CellCorners& corners_of(mesh::CellType type) {
  using mesh::CellType;
  static const std::map<CellType, CellCorners> kinds{
      {CellType::triangle,
       {{{0, 1}, {1, 2}, {2, 0}}, {{0, 1, 2, -1}, {1, 2, 0, -1}, {2, 0, 1, -1}}, 2 / std::sqrt(3.0)}},
      {CellType::quadrilateral,
       {{{0, 1}, {1, 2}, {2, 3}, {3, 0}}, {{0, 1, 3, -1}, {1, 2, 0, -1}, {2, 3, 1, -1}, {3, 0, 2, -1}}}},
      {CellType::tetrahedron,
       {{{0, 1}, {1, 2}, {2, 0}, {0, 3}, {1, 3}, {2, 3}},
        {{0, 1, 2, 3}, {1, 2, 0, 3}, {2, 0, 1, 3}, {3, 0, 2, 1}},
        std::sqrt(2.0)}},
      {CellType::hexahedron,
       {{{0, 1}, {1, 2}, {2, 3}, {3, 0}, {4, 5}, {5, 6}, {6, 7}, {7, 4}, {0, 4}, {1, 5}, {2, 6}, {3, 7}},
        {{0, 1, 3, 4},
         {1, 2, 0, 5},
         {2, 3, 1, 6},
         {3, 0, 2, 7},
         {4, 7, 5, 0},
         {5, 4, 6, 1},
         {6, 5, 7, 2},
         {7, 6, 4, 3}}}},
      {CellType::prism,
       {{{0, 1}, {1, 2}, {2, 0}, {3, 4}, {4, 5}, {5, 3}, {0, 3}, {1, 4}, {2, 5}},
        {{0, 1, 2, 3}, {1, 2, 0, 4}, {2, 0, 1, 5}, {3, 5, 4, 0}, {4, 3, 5, 1}, {5, 4, 3, 2}},
        2 / std::sqrt(3.0)}},
      {CellType::pyramid,
       {{{0, 1}, {1, 2}, {2, 3}, {3, 0}, {0, 4}, {1, 4}, {2, 4}, {3, 4}},
        {{0, 1, 3, 4}, {1, 2, 0, 4}, {2, 3, 1, 4}, {3, 0, 2, 4}},
        std::sqrt(2.0)}}};
  return kinds.at(type);
}

}  // namespace couplet::mesh_mover
