// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <vector>

#include "fluid_solver/motion/step_work.hpp"

namespace couplet::fluid {

/// Boundaries that let pressure waves out: with v the speed outward at a face beyond what is given there, at t^{n+1/2}
///   outlet: p_b = p_given + rho c (v - mean v),  v = phi/S
///   inlet:  rho c v = p_b - mean p_b,            v = (w - given).n
/// the means over the patch and over some time, so that what is given holds in the end. Implicit: v at t^{n+1/2} is
/// middle_weights() of v at t^{n+1} and before, which scales the conductance of the face by 1/(1 + a c dt g/S).
template <int D>
class AbsorbingBoundaries {
 public:
  AbsorbingBoundaries(StepWork<D>& work, double size);

  /// For the work's step. Collective.
  void prepare(const State<D>& from);
  /// a, of v at t^{n+1}.
  double weight() const { return weight_[0]; }
  /// To what the faces add to the diagonal of the pressure equation, per boundary face [m].
  void add_admittance(std::vector<double>& values) const;
  /// Sets the boundary's pressure, the given velocity and phi^p as far as they are known before p.
  void foresee(const State<D>& from);
  /// `b`: what the faces of given pressure take off what they have there, per owned cell.
  void add_to(std::vector<double>& b) const;
  /// Boundary pressure and velocity once p is known.
  void follow();
  /// state.openings of the step that has become level n+1; phi and w are those of the work. Collective.
  void commit(State<D>& state) const;
  /// Of a state that no step made. Collective.
  void start(State<D>& state) const;

 private:
  double share(Index b) const;
  double past(Index b) const;
  void means_of(const std::vector<double>& v, const std::vector<double>& p, const Placement<D>& at,
                std::vector<double>& means) const;

  StepWork<D>& k_;
  double mean_time_;                       // [s]
  std::array<double, 3> weight_{};         // of v at t^{n+1}, t^n, t^{n-1}
  const OpeningsState* before_ = nullptr;  // of level n
  std::vector<double> mean_;               // at t^{n+1/2}, per patch
};

}  // namespace couplet::fluid
