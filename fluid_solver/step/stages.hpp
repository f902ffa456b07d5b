// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "fluid_solver/momentum/implicit_friction.hpp"
#include "fluid_solver/momentum/rates.hpp"
#include "fluid_solver/motion/scene.hpp"

namespace couplet::fluid {

/// Velocity gradient computed last, with the state it belongs to; skewed meshes only.
template <int D>
struct KnownGradient {
  std::vector<Tensor<D>> values;
  std::uint64_t number = 0;  ///< State::number; 0 if it belongs to no state
  const std::vector<Tensor<D>>* of(const State<D>& state) const {
    return number != 0 && number == state.number ? &values : nullptr;
  }
};

/// The first stage of a fractional step:
///   V' u^p = V u^n + dt [(1 + r/2) R^n - r/2 R^{n-1}] + sum dV_f u_f~ - (dt/rho) sum p_f^{n-1/2} (S^{n+1/2} - S^{n+1})
/// Here r = dt/dt_old and u~ = (1 + r/2) u^n - r/2 u^{n-1}. Modified Crank-Nicolson if implicit.
template <int D>
class Predictor {
 public:
  /// `result`: filled here except for w, which is given.
  Predictor(const Scene<D>& scene, const Step<D>& step, const KnownGradient<D>& gradient,
            Prediction<D>& result);

  /// Computes u^p in the owned cells and the viscous force of the walls. Collective.
  void predict(const State<D>& from);
  /// Sets R of a state and its viscous force on the boundary faces in the prediction. Collective.
  void set_rates(const State<D>& from, bool implicit);
  RateOperator<D>& rate_operator() { return rate_operator_; }
  int iterations() const { return friction_.iterations(); }

 private:
  void set_explicit_friction(const State<D>& from, double e0, double e1);
  void add_body_force(const State<D>& from, double e0, double e1);
  void add_swept(const State<D>& from, double e0, double e1);
  void add_old_pressure(const State<D>& from, bool implicit);
  void solve_viscous(const State<D>& from, double a);
  void add_back_old_pressure();

  const Scene<D>& scene_;
  const mesh::Mesh& mesh_;
  const Step<D>& step_;
  const KnownGradient<D>& gradient_;
  Prediction<D>& out_;
  RateOperator<D> rate_operator_;
  ImplicitFriction<D> friction_;
  Vectors<D> side_;          // right-hand side
  Vectors<D> u_boundary_;    // at the boundary, from u^p
  Vectors<D> old_pressure_;  // dt/rho sum p^{n-1/2} S^{n+1}; implicit predictor on a moving mesh only
};

/// Predicts the volume fluxes phi^p = (mean u^p).S^{n+1} + delta' - (dt/rho) grad p~ . k. Also updates delta
/// = phi - (mean u).S from step to step, as `projection` selects (README).
template <int D>
class FaceFlux {
 public:
  /// `gradient`: filled here.
  FaceFlux(const Scene<D>& scene, const Step<D>& step, KnownGradient<D>& gradient)
      : scene_(scene), mesh_(scene.mesh), step_(step), gradient_(gradient) {}

  /// Predicts phi^p without the pressure part, per flux face [m^3/s]. Collective.
  void predict(const State<D>& from, const Vectors<D>& u);
  const std::vector<double>& phi() const { return phi_; }
  /// Sets delta^{n+1} of the state from its u and phi. Collective.
  void remember(State<D>& state);

 private:
  void set_relaxation(const State<D>& from);
  void add_memory(const State<D>& from);
  void add_increment(const State<D>& from);
  bool increment_of_fourth() const;
  const Vectors<D>& without_pressure(const Vectors<D>& u);
  double pressure_flux(const State<D>& from, Index f) const;
  double pressure_excess(const State<D>& from, const Vectors<D>& gradient, Index f) const;

  const Scene<D>& scene_;
  const mesh::Mesh& mesh_;
  const Step<D>& step_;
  KnownGradient<D>& gradient_;
  std::vector<double> phi_;
  Vectors<D> u_boundary_;           // from the predicted velocity
  std::vector<double> relaxation_;  // [1/s]
  std::vector<Index> far_;          // faces with a large decay
  Vectors<D> without_pressure_;
  std::vector<double> fading_;  // incremental: factor of the initial delta, at t^{n+1}
};

}  // namespace couplet::fluid
