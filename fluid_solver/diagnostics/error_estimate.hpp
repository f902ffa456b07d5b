// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <span>
#include <vector>

#include "common/diagnostics/error_parts.hpp"
#include "common/io/archive.hpp"
#include "common/time/step_errors.hpp"
#include "fluid_solver/diagnostics/driving.hpp"
#include "fluid_solver/diagnostics/phase_drift.hpp"
#include "fluid_solver/diagnostics/view.hpp"

namespace couplet::fluid {

/// What a run leaves in the velocity, over its size, as norms over the volume:
///   mesh    difference of u from the value that a linear fit through the neighbours of each cell has in it, h^2/4
///           times the Laplacian of u on equal cells: recovery of the values
///   step    sum of the local errors 5/12 dt^3 d3u/dt3 of Adams and Bashforth's second order, see StepErrors; of
///           k sub-steps each k^-3. The flow forgets at the rate at which it is renewed, outflow over volume, and at which
///           friction takes what work has brought in, (W' - E')/(2 E). Where a clock drives it
///           (Driving) and it answers linearly (convection is a small share of its rate of change) no error drifts: the sum
///           of the local errors as vectors, which turn back with each half period, counts if it is less; friction that holds the
///           flow to its forces, r dt above 1, makes the force's time its own: (w dt)^2/8 of an oscillation. One that nothing
///           drives and that repeats itself drifts in phase, see PhaseDrift: of this and the sum the larger one counts
///   linear  what the pressure's solver leaves of the cells' net outflow against what passes through them, times the
///           square root of the number of cells across: an outflow that alternates moves its neighbours alone, one
///           that does not the whole field; this is the mean of the two in logarithms
/// Collective.
template <int D>
class FluidErrorEstimate final : public diagnostics::Diagnostic {
 public:
  explicit FluidErrorEstimate(const FluidView<D>& view)
      : view_(view), fluid_(view.fluid), driving_(view.parameters()) {}
  void observe(diagnostics::Report&) override { accepted(view_.step.dt); }
  void conclude(diagnostics::Report& report) override { report.errors = parts(); }
  void visit(io::Archive& archive) override;

 private:
  void accepted(double dt);
  diagnostics::ErrorParts parts() const;
  double size(const Vectors<D>& values) const;
  /// Of differences of the change of the rate, and of the change itself: local errors of a step, and of one that a clock drives.
  struct Weights {
    double local = 0, of_third = 0, of_second = 0;
  };
  Weights weights(double dt, double apart) const;
  void sum_differences(double per_step, double per_apart, const Weights& weights,
                       std::array<double, 8>& squares);
  void see_energy(double dt);
  double friction() const;
  double step_part() const;
  double recovered_difference() const;
  double net_outflow() const;
  void add_compression(std::vector<double>& net) const;

  FluidView<D> view_;
  const Fluid<D>& fluid_;
  Vectors<D> u_, rate_, rate_change_;  // u of the last accepted step, first and second differences in time
  int seen_ = 0;                       // steps that these hold
  bool judged_ = false;                // a step has been judged
  double dt_old_ = 0;
  time::StepErrors steps_;
  PhaseDrift drift_;
  double time_ = 0;                           // judged so far [s]
  double power_ = 0, gain_ = 0, energy_ = 0;  // means of late: work and gain of energy [W], energy [J]
  double work_ = 0, held_ = 0;                // what the ledger had: work and energy [J]
  Driving driving_;
  Vectors<D> left_;          // sum of local errors; empty: nothing drives
  double left_of_late_ = 0;  // norm, the largest of late
  double carried_ = 0,
         changed_ = 0;  // largest of late: the part of the rates that is convection, and the rates [m/s^2]
};

}  // namespace couplet::fluid
