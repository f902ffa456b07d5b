// SPDX-License-Identifier: Apache-2.0
#include "plate_modal/model/outline.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "common/base/constants.hpp"

namespace couplet::plate {
namespace {

constexpr double sharp = 55 * base::degree, least = 0.5 * base::degree, least_share = 0.6;
// Below it a corner is told: right angles have 2.
constexpr double least_order = 1.9;

struct Neighbours {
  int in = -1, out = -1;  // edges of the outline that end and start at a point; -2: several
};

Vec2 along(const Midsurface& s, int edge) {
  return s.points[s.edges[edge].to] - s.points[s.edges[edge].from];
}

/// Angle from one edge to the next, to the left positive.
double turn_between(const Midsurface& s, int first, int second) {
  const Vec2 a = along(s, first), b = along(s, second);
  return std::atan2(a.x() * b.y() - a.y() * b.x(), a.dot(b));
}

/// What a curve turns between the middle of its last edge and its end, from the turn before that edge. Where nothing is
/// known of that (the curve has one edge, or a sharp corner lies there) the curve goes on as a circle over a point within it, and as a
/// line up to a point between two curves.
double turn_to_end(const Midsurface& s, int edge, int beyond, int other, double turn_here) {
  const bool is_after = beyond >= 0 && s.edges[edge].to == s.edges[beyond].from;
  const double here = along(s, edge).norm();
  if (beyond >= 0 && s.edges[edge].curve == s.edges[beyond].curve)
    if (const double turn = is_after ? turn_between(s, edge, beyond) : turn_between(s, beyond, edge);
        std::abs(turn) <= sharp)
      // No more than the turn itself: a corner next to this point is none of the curve's own.
      return std::clamp(turn * here / (here + along(s, beyond).norm()), -std::abs(turn_here),
                        std::abs(turn_here));
  const bool within = std::abs(turn_here) <= sharp && s.edges[edge].curve == s.edges[other].curve;
  return within ? turn_here * here / (here + along(s, other).norm()) : 0;
}

/// The direction `a`, turned to the left.
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

double with_corners(double gap, std::span<const double> kinks) {
  constexpr double counts_fully = 20 * base::degree;
  double most = gap;
  for (const double kink : kinks)
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
