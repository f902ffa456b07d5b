// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "fluid_solver/motion/step_work.hpp"

namespace couplet::fluid {

/// Predicted volume fluxes through the faces, phi^p = (mean u^p).S^{n+1} + delta' - (dt/rho) grad p~ . k, and what
/// becomes of delta = phi - (mean u).S from step to step, by `projection` (README).
template <int D>
class FaceFlux {
 public:
  explicit FaceFlux(StepWork<D>& work) : k_(work) {}

  /// phi^p without the part of the pressure. Collective.
  void predict(const State<D>& from);
  /// delta^{n+1} of the state from its u and phi. Collective.
  void remember(State<D>& state);

 private:
  void remember_cuts(State<D>& s);
  void set_relaxation(const State<D>& from);
  void add_memory(const State<D>& from);
  void add_increment(const State<D>& from);
  bool increment_of_fourth() const;
  const Vectors<D>& without_pressure();
  double pressure_flux(const State<D>& from, Index f) const;
  double pressure_excess(const State<D>& from, const Vectors<D>& gradient, Index f) const;

  StepWork<D>& k_;
  std::vector<double> relaxation_;  // [1/s]
  std::vector<Index> far_;          // faces whose decay is large
  std::vector<double> mean_;        // fluxes beside the surface of bodies that cut cells
  Vectors<D> without_pressure_;
  std::vector<double> fading_;  // incremental: of the start's delta, at t^{n+1}
};

}  // namespace couplet::fluid
