// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "fluid_solver/motion/step_work.hpp"
#include "fluid_solver/pressure/wave_rule.hpp"

namespace couplet::fluid {

/// Of the work's step; three levels at most.
template <int D>
WaveRule wave_rule(const StepWork<D>& k) {
  std::array<double, 2> times{};
  std::size_t levels = 0;
  while (levels < times.size() && k.by.pressure[levels]) {
    times[levels] = k.by.pressure[levels]->time;
    ++levels;
  }
  return three_level_rule(k.by.time + k.step.dt / 2, k.by.time + k.step.dt, std::span(times).first(levels));
}

/// Weak compressibility in the pressure equation: dp/dt + rho c^2 div u = 0 in every cell, u relative to faces that may
/// move, for changes of density that are small and Mach numbers below about 0.3. At t^{n+1} with p = p^{n+1/2}
///   rho c^2 div u^{n+1} = -(rate p + past),
/// by the three levels of WaveRule, or by the trapezoidal rule 2 (p - p^n)/dt = -rho c^2 (div u^{n+1} + div u^n)/2 with
/// p^{n+1} = 2 p - p^n, which keeps the energy of what a step does not resolve, too. In the pressure equation
/// V rate/(c^2 dt) joins the diagonal and -V past/(c^2 dt) the right side.
template <int D>
class Compression {
 public:
  explicit Compression(StepWork<D>& work);

  /// For the work's step.
  void prepare(const State<D>& from);
  /// False in a step that starts a flow without a pressure.
  bool active() const { return rate_ > 0; }
  /// Of p in dp/dt at the end of the step [1/s].
  double rate() const { return rate_; }
  /// Per owned cell [m]; none in blocked cells.
  const std::vector<double>& storage() const { return storage_; }
  /// `b`: per owned cell. Gives the size of b less what of it holds p as it was: what the step changes, by which the
  /// solution is to be judged. Collective.
  double add_to(std::vector<double>& b) const;
  /// What follows from p alone to the next step.
  void complete(PressureLevel<D>& level) const;

 private:
  void set_past(const State<D>& from);
  const std::vector<double>& begin() const;

  StepWork<D>& k_;
  bool trapezoidal_;
  double rate_ = 0;
  std::vector<double> past_, storage_;  // per owned cell [Pa/s], [m]
};

}  // namespace couplet::fluid
