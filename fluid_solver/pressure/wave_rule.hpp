// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <span>

#include "fluid_solver/state/step.hpp"

namespace couplet::fluid {

/// dp/dt at the end of a step from pressures in the middles of steps: rate p + sum past_k p_k, p that of the step itself,
/// p_k those before. The derivative there of the parabola through three levels, with equal steps
/// (2 p - 3 p_1 + p_2)/dt; of a line through two; 0 with one. L-stable for waves: with W = c k dt
/// (2 z - 1)(z - 1)^2 + W^2 z^3 = 0 has |z| < 1.
struct WaveRule {
  double rate = 0;  ///< [1/s]; 0: no level before, the step is incompressible
  std::array<double, 2> past{};
};

/// `times`: of the levels before, latest first; two of them count.
inline WaveRule three_level_rule(double middle, double end, std::span<const double> times) {
  WaveRule rule;
  const double h = end - middle;
  if (times.empty()) return rule;
  const double h1 = end - times[0];
  if (times.size() == 1) {
    rule.rate = 1 / (h1 - h);
    rule.past[0] = -rule.rate;
    return rule;
  }
  const double h2 = end - times[1];
  rule.rate = (h1 + h2) / ((h1 - h) * (h2 - h));
  rule.past[0] = (h + h2) / ((h - h1) * (h2 - h1));
  rule.past[1] = (h + h1) / ((h - h2) * (h1 - h2));
  return rule;
}

/// Weights of v at t^{n+1}, t^n and t^{n-1} for a value at t^{n+1/2}: of second order, and what is stiff goes with -1/3 a
/// step, as in the implicit viscous term. `old`: size of the step before, 0: none, and no order.
inline std::array<double, 3> middle_weights(double dt, double old) {
  constexpr double c = 1.0 / 16;
  if (old <= 0) return {1, 0, 0};
  const double a = 0.5 + c * old / dt;
  return {a, 1 - a - c, c};
}

/// The rule of a step; three levels at most.
template <int D>
WaveRule wave_rule(const Step<D>& step) {
  std::array<double, 2> times{};
  std::size_t levels = 0;
  while (levels < times.size() && step.by.pressure[levels]) {
    times[levels] = step.by.pressure[levels]->time;
    ++levels;
  }
  return three_level_rule(step.middle(), step.end(), std::span(times).first(levels));
}
/// Factor of p in dp/dt at the end of the step [1/s]; 0 in a step that starts a flow without a pressure.
template <int D>
double wave_rate(const Step<D>& step, bool trapezoidal) {
  if (!step.by.pressure[0]) return 0;
  return trapezoidal ? 4 / step.dt : wave_rule(step).rate;
}

}  // namespace couplet::fluid
