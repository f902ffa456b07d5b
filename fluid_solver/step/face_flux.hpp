// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "fluid_solver/step/predictor.hpp"

namespace couplet::fluid {

/// Predicted volume fluxes through the faces, phi^p = (mean u^p).S^{n+1} + delta' - (dt/rho) grad p~ . k, and what
/// becomes of delta = phi - (mean u).S from step to step, by `projection` (README).
template <int D>
class FaceFlux {
 public:
  /// `gradient`: filled here.
  FaceFlux(const Scene<D>& scene, const Step<D>& step, KnownGradient<D>& gradient)
      : scene_(scene), mesh_(scene.mesh), step_(step), gradient_(gradient) {}

  /// phi^p of a predicted velocity without the part of the pressure, per flux face [m^3/s]. Collective.
  void predict(const State<D>& from, const Vectors<D>& u);
  const std::vector<double>& phi() const { return phi_; }
  /// delta^{n+1} of the state from its u and phi. Collective.
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
  Vectors<D> u_boundary_;           // of the predicted velocity
  std::vector<double> relaxation_;  // [1/s]
  std::vector<Index> far_;          // faces whose decay is large
  Vectors<D> without_pressure_;
  std::vector<double> fading_;  // incremental: of the start's delta, at t^{n+1}
};

}  // namespace couplet::fluid
