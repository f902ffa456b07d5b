// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <vector>

#include "fluid_solver/pressure/term.hpp"

namespace couplet::fluid {

/// Boundaries that let pressure waves out: with v the speed outward at a face beyond what is given there, at t^{n+1/2}
///   outlet: p_b = p_given + rho c (v - mean v),  v = phi/S
///   inlet:  rho c v = p_b - mean p_b,            v = (w - given).n
/// the means over the patch and over some time, so that what is given holds in the end. Implicit: v at t^{n+1/2} is
/// middle_weights() of v at t^{n+1} and before, which scales the conductance of the face by 1/(1 + a c dt g/S).
template <int D>
class AbsorbingBoundaries final : public Term<D> {
 public:
  AbsorbingBoundaries(const Scene<D>& scene, const Step<D>& step, const Prediction<D>& prediction);

  void prepare(const State<D>& from) override;
  double version() const override { return weight_[0] * step_.dt; }
  void add_to_diagonal(Diagonal& diagonal) override;
  void foresee(const State<D>& from, Projected<D>& projected) override;
  /// Subtracts at faces of given pressure what their answer takes away.
  void before(Projected<D>& projected, RightSide& side) override;
  void after(Projected<D>& projected) override;
  /// Sets state.openings.
  void commit(const Projected<D>& projected, State<D>& state) const override;
  void start(State<D>& state) const override;
  using Term<D>::start;

 private:
  using Term<D>::scene_;
  using Term<D>::mesh_;
  using Term<D>::step_;
  using Term<D>::prediction_;
  double share(Index b) const;
  double past(Index b) const;
  void means_of(const std::vector<double>& v, const std::vector<double>& p, const Placement<D>& at,
                std::vector<double>& means) const;

  double mean_time_;                       // [s]
  std::array<double, 3> weight_{};         // of v at t^{n+1}, t^n, t^{n-1}
  const OpeningsState* before_ = nullptr;  // of level n
  std::vector<double> mean_;               // at t^{n+1/2}, per patch
};

}  // namespace couplet::fluid
