// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "fluid_solver/motion/step_work.hpp"

namespace couplet::fluid {

/// Forces on what is outside the fluid: +p_b S^{n+1/2}, p extrapolated linearly to the wall, and the wall
/// shear, which follows the wall velocity of each projection.
template <int D>
class Loads {
 public:
  explicit Loads(StepWork<D>& work);

  /// Of the prediction: what correct_shear() starts from.
  void remember_prediction(bool implicit);
  void correct_shear();
  void set_forces(const State<D>& from);
  /// Of the last set_forces() [N].
  const Vectors<D>& pressure_force() const { return pressure_force_; }

 private:
  void extrapolate_to_walls();
  struct Fit {
    Tensor<D> matrix = Tensor<D>::Zero();
    Vec<D> side = Vec<D>::Zero();
    bool usable = false;
  };

  StepWork<D>& k_;
  std::vector<Fit> fits_;          // of the cells at walls
  std::vector<Index> slot_;        // per local cell: which of the fits; -1: none
  std::vector<Index> near_walls_;  // interior faces of those cells
  std::vector<double> p_wall_;     // per boundary face, for the load [Pa]
  Vectors<D> pressure_force_;
  std::vector<Index> interface_faces_;        // boundary faces
  Vectors<D> w_predicted_, shear_predicted_;  // what the predictor took and gave there
  double shear_weight_ = 0;                   // of t^{n+1} in the mean shear
};

}  // namespace couplet::fluid
