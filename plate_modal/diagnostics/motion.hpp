// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <limits>
#include <span>
#include <vector>

#include "plate_modal/motion/oscillators.hpp"

namespace couplet::plate {

/// Collects, step by step, which modes move, how well the steps resolve them and how fast the load swings. It keeps sums
/// of each mode alone.
class Motion final {
 public:
  /// The share of coarse modes that matters: docs/plate.md.
  static constexpr double coarse_limit = 0.1;
  /// NaN: nothing can be said.
  struct Evidence {
    static constexpr double unknown = std::numeric_limits<double>::quiet_NaN();
    /// Root mean square over mass and time of the swings of modes with less than ten steps per period, over that of
    /// the displacement without rigid motions.
    double coarse_share = unknown;
    int coarse_mode = 0;          ///< the one that swings most of them, from 1
    double steps_a_period = 0;    ///< of that mode
    double recommended_step = 0;  ///< twenty steps per period of the highest mode that matters [s]
    /// Error of a mode that a changing load drives, by the step's error of its frequency: 2 (error of the frequency)
    /// (amplification of the load's motion), times the mode's share of the displacement.
    double resonance_error = unknown;
    int resonant_mode = 0;
    double amplification = 0;          ///< of that mode
    double resonant_step = 0;          ///< that brings the error to a fifth of the limit [s]
    double last_mode_omega = unknown;  ///< highest mode with 1 % of the motion [1/s]
    /// Angular frequency of a load that goes up and down: the lesser of pi times its turns per second and of its rms
    /// change over its rms [1/s]; and that over the highest mode's.
    double load_omega = unknown, load_over_last = unknown;
  };

  explicit Motion(std::span<const double> omega);

  /// A step of length `dt` has been accepted; `load`: in it, on each mode, without gravity and seat.
  void accepted(const ModalState& before, const ModalState& after, std::span<const double> load, double dt);
  /// `at_end`: nothing comes after. Before a quarter of the longest period nothing is said: the slow modes have
  /// not answered yet, and the fast ones carry what there is.
  Evidence evidence(bool at_end) const;
  /// Integral over time of the square of its displacement [kg m^2 s].
  double moved(std::size_t mode) const { return modes_[mode].moved; }
  /// For checkpoints.
  template <class Numbers>
  void visit(Numbers& numbers) {
    numbers(time_, steps_, rigid_, modes_);
  }

 private:
  struct Mode {
    double omega = 0;
    // Integrals over time: square of the displacement, of the swing about what the load holds, and of the part of the
    // latter in steps that were too long for it [kg m^2 s]; the longest of these steps [s].
    double moved = 0, swung = 0, coarse = 0, longest_step = 0;
    // While a changing load drives it, integrals over time: square of the rate, of the rate that the load has without
    // inertia, time step^2 times the former; steps; the load's displacement in the last step; largest change.
    double rate = 0, drive = 0, rate_step = 0, driven = 0, last_load = 0, largest_change = 0;
    // Displacement that the load has without inertia, over all steps: its integral, integral of the square and of
    // the square of its change, times that it turned, and the last change that counted.
    double load = 0, load_square = 0, change = 0, turns = 0, last_change = 0;
    template <class Numbers>
    void visit(Numbers& numbers) {
      numbers(omega, moved, swung, coarse, longest_step, rate, drive, rate_step, driven, last_load,
              largest_change, load, load_square, change, turns, last_change);
    }
  };

  double displacement() const;
  void follow(Mode& mode, double rate, double load, double dt);
  void find_resonance(Evidence& evidence, double all) const;
  void find_load(Evidence& evidence) const;

  std::vector<Mode> modes_;
  double longest_period_ = 0;    // of a mode that is no rigid motion
  double time_ = 0, rigid_ = 0;  // [s]; integral over time of the square of rigid motions
  long steps_ = 0;
};

}  // namespace couplet::plate
