// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <limits>
#include <memory>
#include <span>
#include <vector>

#include "common/linalg/linear_solver.hpp"
#include "common/modes/modal_model.hpp"
#include "plate_modal/model/plate_model.hpp"
#include "plate_modal/motion/pressure_load.hpp"

namespace couplet::plate {

/// What the modes that are left out would do under the loads of a run, by static correction: the compliance
/// f (K + s M)^-1 f of the plate against that of its modes, sum (phi . f)^2 / (omega^2 + s), summed over the times at
/// which it was looked (s = 0 for a plate that is held, the square of its first frequency above 0 otherwise). On rank 0.
class Truncation final {
 public:
  /// Stiffens `plate` by s M: it is of no other use then.
  Truncation(PlateModel& plate, const modes::ModalModel& model, const Vec3& normal);

  /// `pressure`: one a cell [Pa], along the normal.
  void look(std::span<const double> pressure);
  /// Share of the compliance that the modes left out have; NaN without a load.
  double share() const {
    return sums_[1] > 0 ? sums_[0] / sums_[1] : std::numeric_limits<double>::quiet_NaN();
  }
  std::vector<double> state() const { return sums_; }
  void restore(const std::vector<double>& state) { sums_ = state; }

 private:
  const PlateModel& plate_;
  std::vector<double> stiffness_;  // omega^2 + s of each mode [1/s^2]
  std::vector<double> means_;      // area times the mean deflection of a cell, cell by cell
  std::unique_ptr<linalg::LinearSolver> solver_;
  std::vector<double> sums_{0, 0};  // compliance left out, compliance
};

/// Of each mode: how far the mean of a cell's corners is from the cell's mean deflection, rms over that of the latter:
/// (pi / n)^2 / 12 in each direction of a wave with n cells in half of it. `cells`: faces of the first side.
std::vector<double> mesh_gaps(const modes::ModalModel& model, std::size_t cells, const Vec3& normal);

/// What a force at the middle of each face makes of pressures that vary within the faces, on the modes of a structure.
struct WithinFaces {
  double apart = 0, size = 0;  ///< squares over all modes, each over (omega^2 + omega_1^2)
};
/// Against sixteen points a face. Zeros for pressures that are the same everywhere, or have no value at t. On rank 0.
WithinFaces within_faces(const modes::ModalModel& model, const PressureLoad& load, double t);

/// Squares over all modes: of the loads of pressures on them, and of what these would be if every force lay along the
/// motion of its face. Zeros where a pressure has no value at t. On rank 0.
struct LoadOnModes {
  double part = 0, most = 0;
};
LoadOnModes load_on_modes(const modes::ModalModel& model, const PressureLoad& load, double t);

}  // namespace couplet::plate
