// SPDX-License-Identifier: Apache-2.0
#include "fluid_solver/motion/open_part.hpp"

#include <algorithm>
#include <cmath>

namespace couplet::fluid {
namespace {

constexpr int most_trials = 60;
constexpr double root_found = 1e-14;  // of the edge

/// Share of an edge from the corner above zero to where the level is zero: false position, with half of the value of an end
/// that stays (Illinois), else halving. A level that is linear takes one trial.
double way(const LevelCorner& above, const LevelCorner& below, const Level& level, double round_off) {
  double low = 0, high = 1, at_low = above.level - round_off, at_high = below.level - round_off;
  for (int trial = 0; trial < most_trials && high - low > root_found; ++trial) {
    const bool halve = trial % 4 == 3;
    const double s = halve ? 0.5 * (low + high) : low + (high - low) * at_low / (at_low - at_high);
    const double there = level(above.place + s * (below.place - above.place)) - round_off;
    if (std::abs(there) <= root_found * above.level) return s;
    if (there > 0) {
      low = s, at_low = there;
      if (!halve) at_high /= 2;
    } else {
      high = s, at_high = there;
      if (!halve) at_low /= 2;
    }
  }
  return low;
}

}  // namespace

/// Where one corner alone is above zero, or alone is not, the part is a simplex with its tip there; of a tetrahedron with two
/// above, a and b, it is a prism with the corners a, b and the places on the four other edges: three tetrahedra.
OpenPart open_part(std::span<const LevelCorner> corners, const Level& level, double round_off) {
  std::array<std::size_t, 4> order{0, 1, 2, 3};
  const std::size_t n = corners.size();
  const auto is_above = [&](std::size_t i) { return corners[i].level > round_off; };
  const auto above =
      std::size_t(std::partition(order.begin(), order.begin() + std::ptrdiff_t(n), is_above) - order.begin());
  if (above == 0) return {};
  double mean = 0;
  for (const LevelCorner& c : corners) mean += c.level / double(n);
  if (above == n) return {1, mean};
  const auto at = [&](std::size_t i) { return corners[order[i]].level; };
  const auto between = [&](std::size_t i, std::size_t j) {
    return way(corners[order[i]], corners[order[j]], level, round_off);
  };
  if (above == 1) {
    double share = 1;
    for (std::size_t j = 1; j < n; ++j) share *= between(0, j);
    return {share, share * at(0) / double(n)};
  }
  if (above + 1 == n) {
    OpenPart open;
    double rest = 1, sum = mean * double(n) - at(above);
    for (std::size_t k = above; k-- > 0;) {
      const double along = between(k, above);
      open.share += along * rest;
      open.moment += along * rest * sum / double(n);
      rest *= 1 - along;
      sum -= at(k);
    }
    return open;
  }
  const double ac = between(0, 2), ad = between(0, 3), bc = between(1, 2), bd = between(1, 3);
  const std::array<double, 3> part{ac * ad, ad * bc * (1 - ac), bc * bd * (1 - ad)};
  return {part[0] + part[1] + part[2], (part[0] * (at(0) + at(1)) + (part[1] + part[2]) * at(1)) / 4};
}

}  // namespace couplet::fluid
