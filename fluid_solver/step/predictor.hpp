// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "common/fv/expression.hpp"
#include "fluid_solver/momentum/implicit_friction.hpp"
#include "fluid_solver/momentum/rates.hpp"
#include "fluid_solver/motion/step_work.hpp"

namespace couplet::fluid {

/// The first part of a fractional step:
///   V' u^p = V u^n + dt [(1 + r/2) R^n - r/2 R^{n-1}] + sum dV_f u_f~ - (dt/rho) sum p_f^{n-1/2} (S^{n+1/2} - S^{n+1})
/// r = dt/dt_old; u~ = (1 + r/2) u^n - r/2 u^{n-1}; with an implicit viscous term modified Crank-Nicolson.
template <int D>
class Predictor {
 public:
  explicit Predictor(StepWork<D>& work);

  /// u^p in the owned cells and the viscous force of the walls, from the work's step. Collective.
  void predict(const State<D>& from);
  /// R of a state and its viscous force on the boundary faces. Collective.
  void set_rates(const State<D>& from, bool implicit);
  /// Of the last set_rates().
  Rates<D>& rates() { return rates_; }
  Vectors<D>& shear() { return shear_; }
  /// Of t^{n+1} in the viscous flux of the last predict().
  double weight() const { return weight_; }
  RateOperator<D>& rate_operator() { return rate_operator_; }

 private:
  void set_explicit_friction(const State<D>& from, double e0, double e1);
  void add_body_force(const State<D>& from, double e0, double e1);
  void add_swept(const State<D>& from, double e0, double e1);
  void part_from_gaps(const State<D>& from, bool implicit);
  void add_old_pressure(const State<D>& from, bool implicit);
  void solve_viscous(const State<D>& from, const Vectors<D>& w, double a);
  void add_back_old_pressure();

  StepWork<D>& k_;
  RateOperator<D> rate_operator_;
  ImplicitFriction<D> friction_;
  std::vector<fv::Expression> body_force_;
  Rates<D> rates_;
  Vectors<D> shear_;  // viscous flux through the boundary, of level n
  double weight_ = 0;
  Vectors<D> old_pressure_;  // dt/rho sum p^{n-1/2} S^{n+1}, of an implicit predictor on a moving mesh
};

}  // namespace couplet::fluid
