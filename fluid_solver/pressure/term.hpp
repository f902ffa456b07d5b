// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <memory>
#include <span>
#include <vector>

#include "common/io/checkpoint.hpp"
#include "fluid_solver/motion/scene.hpp"
#include "fluid_solver/pressure/pressure.hpp"
#include "fluid_solver/state/state.hpp"

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

/// Right-hand side of the pressure equation.
struct RightSide {
  std::vector<double> b;  ///< per owned cell
  double size = -1;       ///< by which the solution is judged, see PressureEquation::solve(); below 0: |b|
};

/// A feature in the pressure equation. Every function is called once per step or solve and loops over its faces or cells itself. The
/// scene, the step and its prediction are those of the step under way.
template <int D>
class Term {
 public:
  Term(const Scene<D>& scene, const Step<D>& step, const Prediction<D>& prediction)
      : scene_(scene), mesh_(scene.mesh), step_(step), prediction_(prediction) {}
  virtual ~Term() = default;

  /// After the prediction from a level. Collective.
  virtual void prepare(const State<D>&) {}

  /// In this step the term gives the pressure of a closed domain a level.
  virtual bool sets_level() const { return false; }
  /// Changes where the entries of the matrix do, on a mesh that rests. 0 is that of a matrix without terms.
  virtual double version() const { return 0; }
  virtual void add_to_diagonal(Diagonal&) {}
  /// Entries beside those of the mesh; nullptr if there are none. add_to_diagonal() sets their values.
  virtual const Couplings* couplings() const { return nullptr; }
  /// A new matrix. Collective.
  virtual void respond(PressureEquation<D>&) {}

  /// Sets pressures, velocities and fluxes of the boundary as far as they are known before p. Collective.
  virtual void foresee(const State<D>&, Projected<D>&) {}
  /// Adds to the right-hand side. Collective.
  virtual void before(Projected<D>&, RightSide&) {}
  /// Sets pressures, velocities and fluxes of the boundary once p is known. Collective.
  virtual void after(Projected<D>&) {}

  /// Adds to the level what the next step needs and p determines.
  virtual void complete(PressureLevel<D>&) const {}
  /// Level n+1 in the place of level n. Collective.
  virtual void commit(const Projected<D>&, State<D>&) const {}
  /// A pressure and a state that no step made. Collective.
  virtual void start(const Placement<D>&, PressureLevel<D>&) const {}
  virtual void start(State<D>&) const {}

  /// State of the solvers beside the level, as of the last accept(). load() is collective.
  virtual void accept() {}
  virtual void save(io::CheckpointWriter&) const {}
  virtual void load(io::CheckpointReader&) {}

 protected:
  const Scene<D>& scene_;
  const mesh::Mesh& mesh_;
  const Step<D>& step_;
  const Prediction<D>& prediction_;
};

// The terms, each in the file of its name.

template <int D>
using MakeTerm = std::unique_ptr<Term<D>>(const Scene<D>&, const Step<D>&, const Prediction<D>&);
/// Walls of known mass (Robin condition). Collective.
template <int D>
MakeTerm<D> make_yielding_walls;
/// Openings that let pressure waves out. Collective.
template <int D>
MakeTerm<D> make_absorbing_boundaries;
/// Weak compressibility in the cells.
template <int D>
MakeTerm<D> make_compression;
/// A volume behind the inlets.
template <int D>
MakeTerm<D> make_upstream_volume;

}  // namespace couplet::fluid
