// SPDX-License-Identifier: Apache-2.0
#include "plate_modal/model/plate_model.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "common/base/constants.hpp"
#include "common/base/error.hpp"
#include "common/linalg/linear_solver.hpp"
#include "plate_modal/model/midsurface.hpp"

namespace couplet::plate {
namespace {

/// Minimum angle at which two supports of a point hold its slope in two directions: for edges of one type
/// that meet in a blunt corner, and of two types, whose tangents are less accurate on a coarse mesh. At a
/// blunt corner of simply supported edges both slopes vanish in the limit, but the deflection is only
/// as smooth as r^1.1. A plate of 20 sides with 7 edges is 47 % too stiff with both held, else 15 % too soft.
constexpr double blunt = 25 * base::degree, unlike = 10 * base::degree, rounding = 1e-6;

/// Direction of the slope held by a support at an edge with this tangent: w = 0 along an edge holds the
/// tangential slope, symmetry the normal one.
Vec2 held_direction(Support kind, const Vec2& tangent) {
  return kind == Support::symmetry ? Vec2(tangent.y(), -tangent.x()) : tangent;
}

/// Angle between two lines, up to 90 degrees.
double between_lines(const Vec2& a, const Vec2& b) {
  return std::atan2(std::abs(a.x() * b.y() - a.y() * b.x()), std::abs(a.dot(b)));
}

Triangle corners(const Midsurface& s, const std::array<Index, 3>& p) {
  return {s.points[p[0]], s.points[p[1]], s.points[p[2]]};
}

/// Calls f(points, triangle, share, cell) for each piece of each cell.
template <class F>
void for_pieces(const Midsurface& s, F&& f) {
  for (Index c = 0; c < s.cells.size(); ++c) {
    const auto cell = s.cells[c];
    for (const CornerTriangle& piece : pieces_of(cell.size())) {
      const std::array<Index, 3> points{cell[piece.corner[0]], cell[piece.corner[1]], cell[piece.corner[2]]};
      f(points, corners(s, points), piece.share, c);
    }
  }
}

}  // namespace

PlateModel::PlateModel(Midsurface surface, std::vector<PlateCell> cells, const std::vector<Support>& support)
    : surface_(std::move(surface)), cells_(std::move(cells)) {
  support_points(support);
  const Triplets t = assemble();
  const auto n = static_cast<GlobalIndex>(n_unknowns());
  stiffness_ = std::make_unique<linalg::SparseMatrix>(MPI_COMM_SELF, n, t.row, t.column);
  mass_ = std::make_unique<linalg::SparseMatrix>(MPI_COMM_SELF, n, t.row, t.column);
  stiffness_->fill(t.stiffness);
  mass_->fill(t.mass);
}

void PlateModel::support_points(const std::vector<Support>& support) {
  const std::size_t n = surface_.points.size();
  axis_.assign(n, Vec2::UnitX());
  fixed_.assign(3 * n, false);
  const std::vector<OutlinePoint> outline = outline_of(surface_);
  std::vector<std::vector<std::pair<Support, Vec2>>> held(
      n);  // what holds a point, and the tangent of its edge there
  for (const auto& edge : surface_.edges) {
    const Support kind = support[edge.patch];
    if (kind == Support::free) continue;
    const Vec2 chord = (surface_.points[edge.to] - surface_.points[edge.from]).normalized();
    for (const Index p : {edge.from, edge.to}) {
      const OutlinePoint& at = outline[p];
      held[p].emplace_back(kind, !at.known ? chord : p == edge.from ? at.after : at.before);
    }
  }
  for (std::size_t p = 0; p < n; ++p) {
    if (held[p].empty()) continue;
    for (const auto& [kind, tangent] : held[p]) {
      fixed_[3 * p] = fixed_[3 * p] || kind != Support::symmetry;
      fixed_[3 * p + 2] = fixed_[3 * p + 2] || kind == Support::clamped;
    }
    fixed_[3 * p + 1] = true;
    const OutlinePoint& at = outline[p];
    const auto [kind, tangent] = held[p].front();
    axis_[p] = held_direction(kind, tangent);
    if (held[p].size() < 2) continue;
    const auto [other, other_tangent] = held[p].back();
    if (at.known && kind == other && std::abs(at.kink) <= blunt) {
      axis_[p] = held_direction(kind, (at.before + at.after).normalized());
    } else {
      const double apart = between_lines(axis_[p], held_direction(other, other_tangent));
      fixed_[3 * p + 2] = fixed_[3 * p + 2] || apart > (kind == other ? rounding : unlike);
    }
  }
}

TriangleMatrix PlateModel::turned(const TriangleMatrix& matrix, const std::array<Index, 3>& points) const {
  TriangleMatrix turn = TriangleMatrix::Zero();
  for (int i = 0; i < 3; ++i) {
    const Vec2& a = axis_[points[i]];
    turn(3 * i, 3 * i) = 1;
    turn.block<2, 2>(3 * i + 1, 3 * i + 1) << a.x(), -a.y(), a.y(), a.x();
  }
  return turn.transpose() * matrix * turn;
}

PlateModel::Triplets PlateModel::assemble() const {
  Triplets t;
  double scale = 0;
  for_pieces(surface_, [&](const std::array<Index, 3>& points, const Triangle& x, double share, Index c) {
    const TriangleMatrix k =
        share * turned(bending_stiffness(x, cells_[c].rigidity(), cells_[c].poissons_ratio), points);
    const TriangleMatrix m = share * turned(inertia(x, cells_[c].surface_density()), points);
    scale = std::max(scale, k.diagonal().maxCoeff());
    for (int i = 0; i < 9; ++i)
      for (int j = 0; j < 9; ++j) {
        const std::size_t r = 3 * std::size_t(points[i / 3]) + i % 3,
                          s = 3 * std::size_t(points[j / 3]) + j % 3;
        if (fixed_[r] || fixed_[s]) continue;
        t.row.push_back(static_cast<GlobalIndex>(r));
        t.column.push_back(static_cast<GlobalIndex>(s));
        t.stiffness.push_back(k(i, j));
        t.mass.push_back(m(i, j));
      }
  });
  for (std::size_t r = 0; r < fixed_.size(); ++r) {
    if (!fixed_[r]) continue;
    t.row.push_back(static_cast<GlobalIndex>(r));
    t.column.push_back(static_cast<GlobalIndex>(r));
    t.stiffness.push_back(scale);
    t.mass.push_back(0);
  }
  return t;
}

std::vector<double> PlateModel::to_points(std::span<const double> unknowns) const {
  std::vector<double> points(unknowns.begin(), unknowns.end());
  for (std::size_t p = 0; p < axis_.size(); ++p) {
    const double a = unknowns[3 * p + 1], b = unknowns[3 * p + 2];
    points[3 * p + 1] = axis_[p].x() * a - axis_[p].y() * b;
    points[3 * p + 2] = axis_[p].y() * a + axis_[p].x() * b;
  }
  return points;
}

std::vector<double> PlateModel::to_unknowns(std::span<const double> points) const {
  std::vector<double> unknowns(points.begin(), points.end());
  for (std::size_t p = 0; p < axis_.size(); ++p) {
    const double x = points[3 * p + 1], y = points[3 * p + 2];
    unknowns[3 * p + 1] = axis_[p].x() * x + axis_[p].y() * y;
    unknowns[3 * p + 2] = -axis_[p].y() * x + axis_[p].x() * y;
  }
  return unknowns;
}

std::vector<double> PlateModel::load_of(std::span<const double> pressure) const {
  std::vector<double> points(n_unknowns(), 0);
  for_pieces(surface_, [&](const std::array<Index, 3>& p, const Triangle& x, double share, Index c) {
    const TriangleVector load = share * pressure[c] * area(x) * mean_deflection(x);
    for (int i = 0; i < 9; ++i) points[3 * std::size_t(p[i / 3]) + i % 3] += load[i];
  });
  std::vector<double> rhs = to_unknowns(points);
  for (std::size_t r = 0; r < rhs.size(); ++r)
    if (fixed_[r]) rhs[r] = 0;
  return rhs;
}

std::vector<double> PlateModel::cell_means(std::span<const double> points) const {
  std::vector<double> means(surface_.cells.size(), 0), areas = cell_areas();
  for_pieces(surface_, [&](const std::array<Index, 3>& p, const Triangle& x, double share, Index c) {
    const TriangleVector weight = mean_deflection(x);
    for (int i = 0; i < 9; ++i)
      means[c] += share * area(x) / areas[c] * weight[i] * points[3 * std::size_t(p[i / 3]) + i % 3];
  });
  return means;
}

std::vector<double> PlateModel::cell_areas() const {
  std::vector<double> areas(surface_.cells.size(), 0);
  for_pieces(surface_, [&](const std::array<Index, 3>&, const Triangle& x, double share, Index c) {
    areas[c] += share * area(x);
  });
  return areas;
}

double PlateModel::frequency_scale() const {
  Vec2 low = surface_.points.front(), high = low;
  for (const Vec2& x : surface_.points) low = low.cwiseMin(x), high = high.cwiseMax(x);
  const double length = (high - low).norm();
  double least = std::numeric_limits<double>::infinity();
  for (const PlateCell& c : cells_) least = std::min(least, c.rigidity() / c.surface_density());
  return least / (length * length * length * length);
}

modes::EigenModes PlateModel::modes(int n) const {
  const auto free = std::ranges::count(fixed_, false);
  if (n >= free)
    throw Error(
        "{} modes are requested, but the plate has {} free unknowns, and one mode must be left over. "
        "Request fewer, or use a finer mesh: modes beyond a tenth of the unknowns are mesh artifacts.",
        n, free);
  modes::EigenModes modes = modes::lowest_modes(*stiffness_, *mass_, n, -frequency_scale());
  for (std::vector<double>& shape : modes.shape) {
    // Fixes the sign: the first of the largest deflections is positive.
    double largest = 0;
    for (std::size_t r = 0; r < shape.size(); r += 3) largest = std::max(largest, std::abs(shape[r]));
    for (std::size_t r = 0; r < shape.size(); r += 3) {
      if (std::abs(shape[r]) < 0.999 * largest) continue;
      if (shape[r] < 0)
        for (double& value : shape) value = -value;
      break;
    }
  }
  return modes;
}

std::vector<double> PlateModel::deflect(std::span<const double> load) const {
  linalg::LinearSolver solver("deflection", *stiffness_, {.method = linalg::LinearMethod::direct_symmetric});
  std::vector<double> u(load.size(), 0);
  solver.solve(load, u);
  return u;
}

}  // namespace couplet::plate
