// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <vector>

#include "common/linalg/acceleration.hpp"
#include "fluid_solver/momentum/rates.hpp"
#include "fluid_solver/momentum/viscous_solver.hpp"
#include "fluid_solver/motion/step_work.hpp"

namespace couplet::fluid {

/// The implicit part of modified Crank-Nicolson, V' u^p - a dt nu L' u^p = right side of the work; on oblique meshes in passes. With
/// the stress of an eddy viscosity, explicit and damped.
template <int D>
class ImplicitFriction {
 public:
  ImplicitFriction(StepWork<D>& work, RateOperator<D>& rates)
      : k_(work), rate_operator_(rates), solver_(work.mesh, work.boundary) {}

  /// u^p of the work from its right side, for the velocities w of the boundary. `rates`: of `from`. Collective.
  void solve(const State<D>& from, const Rates<D>& rates, const Vectors<D>& w, double a);

 private:
  double tolerance() const;
  void guess(const State<D>& from, const Rates<D>& rates, double a);
  void add_eddies(const State<D>& from);
  void damp_eddies(const State<D>& from, const EddyShare& eddies);
  void solve_in_passes(const Vectors<D>& w, double a);
  void accelerate(bool start);

  StepWork<D>& k_;
  RateOperator<D>& rate_operator_;
  ViscousSolver<D> solver_;
  Vectors<D> oblique_rate_, right_side_, before_;
  std::vector<double> eddy_;  // of the velocity between the levels, as the next
  Vectors<D> between_, between_boundary_, eddy_rate_;
  std::unique_ptr<linalg::Accelerator> accelerator_;  // of meshes that need many passes
};

}  // namespace couplet::fluid
