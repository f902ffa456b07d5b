// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "fluid_solver/motion/step_work.hpp"

namespace couplet::fluid {

/// Forces on what is outside the fluid: the momentum that the fluid's own equation lets through the wall, +p_b S^{n+1/2} with the
/// scheme's wall pressure and the whole viscous flux mu g (u_P - w) with its weights in time. A pressure extrapolated from the
/// cells and the tangential flux alone differ from it by a layer of the splitting, of first order in the step and the mesh.
template <int D>
class Loads {
 public:
  explicit Loads(StepWork<D>& work);

  /// Of the prediction; `weight`: that of t^{n+1} in its viscous flux, 0 with an explicit predictor.
  void remember_prediction(double weight);
  /// After a projection.
  void set_forces(const State<D>& from);
  /// Of the last set_forces() [N]: pressure and the normal part of the viscous flux; its tangential part.
  const Vectors<D>& pressure_force() const { return pressure_force_; }
  const Vectors<D>& viscous_force() const { return viscous_force_; }

 private:
  void correct_shear();

  StepWork<D>& k_;
  Vectors<D> pressure_force_, viscous_force_;
  std::vector<Index> interface_faces_;          // boundary faces
  Vectors<D> w_predicted_, viscous_predicted_;  // what the predictor took and gave there
  double weight_ = 0;
};

}  // namespace couplet::fluid
