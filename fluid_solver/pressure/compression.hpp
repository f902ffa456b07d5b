// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "fluid_solver/pressure/term.hpp"
#include "fluid_solver/pressure/wave_rule.hpp"

namespace couplet::fluid {

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

/// Weak compressibility in the pressure equation: dp/dt + rho c^2 div u = 0 in every cell, u relative to faces that may
/// move, for changes of density that are small and Mach numbers below about 0.3. At t^{n+1} with p = p^{n+1/2}
///   rho c^2 div u^{n+1} = -(rate p + past),
/// by the three levels of WaveRule, or by the trapezoidal rule 2 (p - p^n)/dt = -rho c^2 (div u^{n+1} + div u^n)/2 with
/// p^{n+1} = 2 p - p^n, which keeps the energy of what a step does not resolve, too. In the pressure equation
/// V rate/(c^2 dt) joins the diagonal and -V past/(c^2 dt) the right side.
template <int D>
class Compression final : public Term<D> {
 public:
  Compression(const Scene<D>& scene, const Step<D>& step, const Prediction<D>& prediction);

  void prepare(const State<D>& from) override;
  bool sets_level() const override { return rate_ > 0; }
  double version() const override { return rate_ / step_.dt; }
  void add_to_diagonal(Diagonal& diagonal) override;
  /// The size of b less what of it holds p as it was is what the step changes.
  void before(Projected<D>& projected, RightSide& side) override;
  void complete(PressureLevel<D>& level) const override;

 private:
  using Term<D>::scene_;
  using Term<D>::mesh_;
  using Term<D>::step_;
  void set_past(const State<D>& from);
  const std::vector<double>& begin() const;

  bool trapezoidal_;
  double rate_ = 0;                     // of p in dp/dt at the end of the step [1/s]
  std::vector<double> past_, storage_;  // per owned cell [Pa/s], [m]; nothing is stored in closed cells
};

}  // namespace couplet::fluid
