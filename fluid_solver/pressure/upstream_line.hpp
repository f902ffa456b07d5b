// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "common/base/error.hpp"
#include "fluid_solver/parameters/parameters.hpp"
#include "fluid_solver/state/state.hpp"

namespace couplet::fluid {

// clang-format off
/// Tube behind the inlets, by the method of characteristics. The pressure p at its mouth and the flow Q into
/// the mesh carry two waves, of which g returns from the far end with its given flow q after 2 L/c:
///   p + Z Q = f,   p - Z Q = g,   Z = rho c/A
///   closed end:     f(t) = g(t - 2 L/c) + 2 Z q(t - L/c)
///   open end:       f(t) = 2 p_end - g(t - 2 L/c)
///   absorbing end:  f(t) = p_end + Z q(t - L/c)
// clang-format on
class UpstreamLine {
 public:
  UpstreamLine(const UpstreamLineParameters& parameters, double rho, double sound)
      : end_(parameters.end),
        pressure_(parameters.pressure),
        travel_(parameters.length / sound),
        impedance_(rho * sound / parameters.area) {}

  double impedance() const { return impedance_; }
  double wave_out(double p, double flow) const { return p - impedance_ * flow; }
  /// f(t). Before the first row of `past` the state was that of the row.
  double wave_in(const std::vector<LineRow>& past, double t) const {
    using End = UpstreamLineParameters::End;
    const double given = impedance_ * at(past, t - travel_, &LineRow::given);
    if (end_ == End::absorbing) return pressure_ + given;
    const double back = at(past, t - 2 * travel_, &LineRow::wave);
    return end_ == End::closed ? back + 2 * given : 2 * pressure_ - back;
  }
  /// Removes rows that are too old to be used after time t.
  void forget(std::vector<LineRow>& past, double t) const {
    const auto used = std::ranges::upper_bound(past, t - 2 * travel_, {}, &LineRow::time);
    if (used - past.begin() > 1) past.erase(past.begin(), used - 1);
  }

 private:
  /// Linear between rows and beyond the last one.
  static double at(const std::vector<LineRow>& past, double t, double LineRow::*value) {
    if (past.size() == 1 || t <= past.front().time) return past.front().*value;
    const auto after = std::min(std::ranges::upper_bound(past, t, {}, &LineRow::time), past.end() - 1),
               before = after - 1;
    return std::lerp(*before.*value, *after.*value, (t - before->time) / (after->time - before->time));
  }

  UpstreamLineParameters::End end_;
  double pressure_, travel_;  // at the far end [Pa]; L/c [s]
  double impedance_;          // Z [Pa s/m^3]
};

}  // namespace couplet::fluid
