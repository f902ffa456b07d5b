// SPDX-License-Identifier: Apache-2.0
#include "plate_modal/model/midsurface.hpp"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <utility>

#include "common/base/constants.hpp"
#include "common/base/error.hpp"

namespace couplet::plate {

namespace {

double cross(const Vec2& a, const Vec2& b) { return a.x() * b.y() - a.y() * b.x(); }

/// Twice the area of the smallest corner triangle; positive for a convex counter-clockwise cell.
double least_corner(const Midsurface& s, std::span<const Index> cell) {
  double least = std::numeric_limits<double>::infinity();
  const std::size_t n = cell.size();
  for (std::size_t i = 0; i < n; ++i) {
    const Vec2 &a = s.points[cell[i]], &b = s.points[cell[(i + 1) % n]], &c = s.points[cell[(i + 2) % n]];
    least = std::min(least, cross(b - a, c - a));
  }
  return least;
}

/// The model is in the x-y plane of the mesh, and 'placement' gives its position in space. A mesh in another
/// plane, or a curved one, would only be seen from above.
void refuse_out_of_plane(const mesh::RawMesh& raw) {
  // Relative to the mesh size: coordinates in a file have no more digits.
  constexpr double tolerance = 1e-6;
  std::vector<Index> used;
  for (Index c = 0; c < raw.cell_points.size(); ++c)
    for (const Index p : raw.cell_points[c]) used.push_back(p);
  if (used.empty()) return;
  Vec3 low = raw.points[used.front()], high = low;
  Index farthest = used.front();
  for (const Index p : used) {
    const Vec3& x = raw.points[p];
    low = low.cwiseMin(x), high = high.cwiseMax(x);
    if (std::abs(x.z()) > std::abs(raw.points[farthest].z())) farthest = p;
  }
  const Vec3& x = raw.points[farthest];
  if (std::abs(x.z()) <= tolerance * (high - low).norm()) return;
  throw Error(
      "The mid-surface does not lie in the plane z = 0: its z ranges from {:.6g} to {:.6g} m, with the "
      "largest distance at ({:.6g}, {:.6g}, {:.6g}). Mesh the plate in that plane and position it with "
      "'placement'; curved or folded sheets are not supported.",
      low.z(), high.z(), x.x(), x.y(), x.z());
}

/// Adds points and cells; returns the new number of each point of the mesh.
std::vector<Index> add_cells(const mesh::RawMesh& raw, Midsurface& s) {
  std::vector<Index> number(raw.points.size(), -1);
  for (Index c = 0; c < raw.cell_points.size(); ++c)
    for (const Index p : raw.cell_points[c]) number[p] = 0;
  for (std::size_t p = 0; p < raw.points.size(); ++p) {
    if (number[p] < 0) continue;
    number[p] = static_cast<Index>(s.points.size());
    s.points.emplace_back(raw.points[p].x(), raw.points[p].y());
  }
  for (Index c = 0; c < raw.cell_points.size(); ++c) {
    std::vector<Index> cell;
    for (const Index p : raw.cell_points[c]) cell.push_back(number[p]);
    if (least_corner(s, cell) <= 0) std::ranges::reverse(cell);
    if (!(least_corner(s, cell) > 0)) {
      const Vec2& x = s.points[cell.front()];
      throw Error("The cell {} of the mid-surface at ({:.6g}, {:.6g}) has zero area or a re-entrant corner.",
                  c + 1, x.x(), x.y());
    }
    s.cells.push_row(cell);
  }
  s.zone = raw.cell_zone;
  s.zone.resize(s.cells.size(), 0);
  s.zones = raw.zones;
  if (s.zones.empty()) s.zones = {"plate"};
  return number;
}

std::map<std::pair<Index, Index>, Index> element_of_edges(const mesh::RawMesh& raw,
                                                          const std::vector<Index>& number) {
  std::map<std::pair<Index, Index>, Index> element;
  for (Index e = 0; e < raw.boundary_points.size(); ++e) {
    const auto ends = raw.boundary_points[e];
    const auto [found, is_new] = element.emplace(std::minmax(number[ends[0]], number[ends[1]]), e);
    const int patch = raw.boundary_patch[found->second];
    if (is_new || patch == raw.boundary_patch[e]) continue;
    const Vec3 middle = 0.5 * (raw.points[ends[0]] + raw.points[ends[1]]);
    throw Error(
        "The edge of the mid-surface at ({:.6g}, {:.6g}) belongs to two patches, '{}' and '{}', but can "
        "have only one boundary condition. Put each curve into exactly one physical curve.",
        middle.x(), middle.y(), raw.patches[patch], raw.patches[raw.boundary_patch[e]]);
  }
  return element;
}

/// Rejects edges of a patch inside the outline, which would have no effect.
void refuse_inside(const Midsurface& s, const mesh::RawMesh& raw,
                   const std::map<std::pair<Index, Index>, Index>& elements,
                   const std::map<std::pair<Index, Index>, int>& uses) {
  for (const auto& [edge, element] : elements) {
    const auto found = uses.find(edge);
    if (found == uses.end() || found->second < 2) continue;
    const Vec2 middle = 0.5 * (s.points[edge.first] + s.points[edge.second]);
    throw Error(
        "The patch '{}' has an edge inside the mid-surface, at ({:.6g}, {:.6g}). Only edges of the outline can be supported: "
        "remove the curve from the physical curves, or cut a slit along it.",
        s.patches[raw.boundary_patch[element]], middle.x(), middle.y());
  }
}

}  // namespace

Midsurface midsurface_of(const mesh::RawMesh& raw, std::span<const int> curves) {
  Midsurface s;
  s.patches = raw.patches;
  refuse_out_of_plane(raw);
  const std::vector<Index> number = add_cells(raw, s);
  std::map<std::pair<Index, Index>, int> uses;
  for (Index c = 0; c < s.cells.size(); ++c)
    for (std::size_t i = 0, n = s.cells[c].size(); i < n; ++i)
      ++uses[std::minmax(s.cells[c][i], s.cells[c][(i + 1) % n])];
  const auto elements = element_of_edges(raw, number);
  refuse_inside(s, raw, elements, uses);
  for (Index c = 0; c < s.cells.size(); ++c)
    for (std::size_t i = 0, n = s.cells[c].size(); i < n; ++i) {
      const Index from = s.cells[c][i], to = s.cells[c][(i + 1) % n];
      const std::pair<Index, Index> edge = std::minmax(from, to);
      const Vec2 middle = 0.5 * (s.points[from] + s.points[to]);
      if (uses[edge] > 2)
        throw Error("{} cells meet at the edge at ({:.6g}, {:.6g}). The mid-surface must be a single sheet.",
                    uses[edge], middle.x(), middle.y());
      if (uses[edge] == 2) continue;
      const auto found = elements.find(edge);
      if (found == elements.end())
        throw Error(
            "The edge of the mid-surface at ({:.6g}, {:.6g}) belongs to no patch. Put the whole outline "
            "into physical curves.",
            middle.x(), middle.y());
      const Index e = found->second;
      s.edges.push_back({from, to, c, raw.boundary_patch[e], curves.empty() ? -1 : curves[e]});
    }
  return s;
}

namespace {

constexpr double sharp = 55 * base::degree, least = 0.5 * base::degree, least_share = 0.6;
// Order below which a corner is reported; right angles have 2.
constexpr double least_order = 1.9;

struct Neighbours {
  int in = -1, out = -1;  // edges of the outline that end and start at a point; -2: several
};

Vec2 along(const Midsurface& s, int edge) {
  return s.points[s.edges[edge].to] - s.points[s.edges[edge].from];
}

/// Angle from one edge to the next, positive to the left.
double turn_between(const Midsurface& s, int first, int second) {
  const Vec2 a = along(s, first), b = along(s, second);
  return std::atan2(a.x() * b.y() - a.y() * b.x(), a.dot(b));
}

/// Turn of a curve between the midpoint of its last edge and its end, from the turn before that edge. If this
/// is unknown (the curve has one edge, or a sharp corner is there), the curve continues as a circle at an
/// inner point, and as a line up to a point between two curves.
double turn_to_end(const Midsurface& s, int edge, int beyond, int other, double turn_here) {
  const bool is_after = beyond >= 0 && s.edges[edge].to == s.edges[beyond].from;
  const double here = along(s, edge).norm();
  if (beyond >= 0 && s.edges[edge].curve == s.edges[beyond].curve)
    if (const double turn = is_after ? turn_between(s, edge, beyond) : turn_between(s, beyond, edge);
        std::abs(turn) <= sharp)
      // At most the turn itself: a corner next to this point is not part of the curve.
      return std::clamp(turn * here / (here + along(s, beyond).norm()), -std::abs(turn_here),
                        std::abs(turn_here));
  const bool within = std::abs(turn_here) <= sharp && s.edges[edge].curve == s.edges[other].curve;
  return within ? turn_here * here / (here + along(s, other).norm()) : 0;
}

/// Direction `a` rotated to the left.
Vec2 turned(const Vec2& a, double angle) { return Eigen::Rotation2Dd(angle) * a.normalized(); }

}  // namespace

std::vector<OutlinePoint> outline_of(const Midsurface& s) {
  std::vector<Neighbours> at(s.points.size());
  for (int e = 0; e < int(s.edges.size()); ++e) {
    int &out = at[s.edges[e].from].out, &in = at[s.edges[e].to].in;
    out = out == -1 ? e : -2;
    in = in == -1 ? e : -2;
  }
  std::vector<OutlinePoint> outline(s.points.size());
  for (std::size_t p = 0; p < s.points.size(); ++p) {
    const auto [in, out] = at[p];
    if (in < 0 || out < 0) continue;
    const double turn = turn_between(s, in, out);
    const double left = turn_to_end(s, in, at[s.edges[in].from].in, out, turn);
    const double right = turn_to_end(s, out, at[s.edges[out].to].out, in, turn);
    const double kink = turn - left - right;
    if (std::abs(turn) > sharp || (std::abs(kink) > least && std::abs(kink) > least_share * std::abs(turn))) {
      outline[p] = {true, turn, kink, turned(along(s, in), left), turned(along(s, out), -right)};
    } else {
      const Vec2 tangent = turned(along(s, in), 0.5 * turn);
      outline[p] = {true, turn, 0, tangent, tangent};
    }
  }
  return outline;
}

double order_at_corner(double kink) {
  const double a = std::numbers::pi / (std::numbers::pi - kink);
  double smoothest = 2;
  for (int k = 1; k <= 4; ++k)
    for (const double mu : {k * a, 2 - k * a})
      if (mu > 1 + 1e-9) smoothest = std::min(smoothest, mu);
  return 2 * (smoothest - 1);
}

double with_corners(double smooth, double gap, std::span<const double> kinks) {
  constexpr double counts_fully = 20 * base::degree;
  double most = smooth;
  for (const double kink : kinks)
    if (order_at_corner(kink) < 1.99)
      most = std::max(most, std::min(1.0, std::abs(kink) / counts_fully) *
                                std::pow(std::min(1.0, gap), 0.5 * order_at_corner(kink)));
  return most;
}

std::vector<Index> blunt_corners(const Midsurface& s, const std::vector<OutlinePoint>& outline,
                                 const std::vector<Support>& support) {
  std::vector<int> held(s.points.size(), 0);
  for (const auto& edge : s.edges)
    if (support[edge.patch] == Support::simply_supported) ++held[edge.from], ++held[edge.to];
  std::vector<Index> found;
  for (std::size_t p = 0; p < s.points.size(); ++p)
    if (held[p] == 2 && outline[p].kink != 0 && order_at_corner(outline[p].kink) < least_order)
      found.push_back(Index(p));
  return found;
}

}  // namespace couplet::plate
