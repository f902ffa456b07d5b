// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <vector>

#include "common/linalg/acceleration.hpp"
#include "fluid_solver/momentum/rates.hpp"
#include "fluid_solver/momentum/viscous_solver.hpp"
#include "fluid_solver/motion/scene.hpp"

namespace couplet::fluid {

/// The implicit part of modified Crank-Nicolson, V' u^p - a dt nu L' u^p = right side; on oblique meshes in passes. With the stress of
/// an eddy viscosity, explicit and damped.
template <int D>
class ImplicitFriction {
 public:
  ImplicitFriction(const Scene<D>& scene, const Step<D>& step, RateOperator<D>& rates)
      : scene_(scene),
        mesh_(scene.mesh),
        step_(step),
        rate_operator_(rates),
        solver_(scene.mesh, scene.boundary) {}

  /// u^p for the velocities w of the boundary. `rates`: of `from`; `side`: changed. Collective.
  void solve(const State<D>& from, const Rates<D>& rates, const Vectors<D>& w, double a, Vectors<D>& side,
             Vectors<D>& u);
  int iterations() const { return iterations_; }

 private:
  double tolerance() const;
  void guess(const State<D>& from, const Rates<D>& rates, double a, const Vectors<D>& side,
             Vectors<D>& u) const;
  void add_eddies(const State<D>& from, Vectors<D>& side);
  void damp_eddies(const State<D>& from, const EddyShare& eddies, Vectors<D>& side) const;
  void solve_in_passes(const Vectors<D>& w, double a, const Vectors<D>& side, Vectors<D>& u);
  void accelerate(bool start, Vectors<D>& u);

  const Scene<D>& scene_;
  const mesh::Mesh& mesh_;
  const Step<D>& step_;
  RateOperator<D>& rate_operator_;
  ViscousSolver<D> solver_;
  int iterations_ = 0;  // so far
  Vectors<D> oblique_rate_, right_side_, before_, u_boundary_;
  std::vector<double> eddy_;  // of the velocity between the levels, as the next
  Vectors<D> between_, between_boundary_, eddy_rate_;
  std::unique_ptr<linalg::Accelerator> accelerator_;  // of meshes that need many passes
};

}  // namespace couplet::fluid
