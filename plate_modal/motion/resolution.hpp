// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <limits>
#include <span>
#include <vector>

#include "plate_modal/motion/oscillators.hpp"
#include "plate_modal/motion/pressure_load.hpp"

namespace couplet::plate {

/// What a run has seen of its time step: whether it resolves the modes that answer, the load and the contact.
/// NaN: nothing to be said.
struct StepEvidence {
  static constexpr double unknown = std::numeric_limits<double>::quiet_NaN();
  /// Root mean square over mass and time of the swings of modes with less than ten steps a period, over that of
  /// the displacement without rigid motions.
  double coarse_share = unknown;
  int coarse_mode = 0;          ///< the one that swings most of them, from 1
  double steps_a_period = 0;    ///< of it
  double recommended_step = 0;  ///< twenty steps a period of the highest mode that matters [s]
  /// What the step's error of a frequency does to a mode that a changing load drives: 2 (error of the frequency)
  /// (amplification of the load's motion), times the mode's share of the displacement.
  double resonance_error = unknown;
  int resonant_mode = 0;
  double amplification = 0,
         resonant_step = 0;          ///< of it; a step that brings the error to a fifth of the limit [s]
  double last_mode_omega = unknown;  ///< of the highest mode with 1 % of the motion [1/s]
  /// Of a load that goes up and down, what it swings with: the lesser of pi times its turns a second and of its rms
  /// change over its rms [1/s]; and that over the highest mode's.
  double load_omega = unknown, load_over_last = unknown;
  double load_apart = unknown;  ///< value in the middle of a step against the mean over it, of the load, rms
  double contact_share = unknown;  ///< a step over the duration pi / omega of the impacts
  double contact_time = 0;         ///< that duration [s]
};

/// Collects it, step by step. Sums of each mode alone: no state of the solution, and no influence on it.
class Resolution final {
 public:
  explicit Resolution(std::span<const double> omega);

  /// A step of length `dt` has been accepted; `load`: in it, on each mode, without gravity and seat.
  void accepted(const ModalState& before, const ModalState& after, std::span<const double> load, double dt);
  /// What the step saw of the load.
  void load(const PressureLoad::Seen& seen);
  /// The seat has done `work` in a step [J]; `stiffness`: what the impact sees of it, over mass [1/s^2];
  /// `energy`: the largest of the structure so far [J].
  void impact(double stiffness, double work, double energy, double dt);

  /// `at_end`: nothing comes after. Before a quarter of the longest period nothing is said: the slow modes have
  /// not answered yet, and the fast ones carry what there is.
  StepEvidence evidence(bool at_end) const;
  /// Of each mode: integral over time of the square of its displacement [kg m^2 s].
  std::span<const double> moved() const { return moved_; }
  long steps() const { return long(sums_[3]); }

  std::vector<double> state() const;
  void restore(const std::vector<double>& state);

 private:
  template <class R>
  static auto parts(R& r);
  double displacement() const;
  void follow(std::size_t mode, double rate, double load, double dt);
  void find_resonance(StepEvidence& evidence, double all) const;
  void find_load(StepEvidence& evidence) const;

  std::vector<double> omega_;
  double longest_period_ = 0;  // of a mode that is no rigid motion
  // Of each mode, integrals over time: square of the displacement, of the swing about what the load holds, and of
  // the part of the latter in steps that were too long for it [kg m^2 s]; the longest of these steps [s].
  std::vector<double> moved_, swung_, coarse_, longest_step_;
  // Of each mode that a changing load drives, integrals over time: square of the rate, of the rate that the load has
  // without inertia, times step^2 of the former; steps; the load's displacement in the last step; largest change.
  std::vector<double> rate_, drive_, rate_step_, driven_, last_load_, largest_change_;
  // Of the displacement that the load has without inertia, over all steps: integral, integral of the square and of the
  // square of its change, times that it turned, and the last change that counted.
  std::vector<double> load_, load_square_, change_, turns_, last_change_;
  // Time [s], square of rigid motions, impact: (share, duration), steps; load: apart, size, samples.
  std::vector<double> sums_;
};

}  // namespace couplet::plate
