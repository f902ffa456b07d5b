// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <limits>
#include <span>
#include <vector>

#include "plate_modal/motion/oscillators.hpp"

namespace couplet::plate {

/// Collects over the steps which modes move, how well the steps resolve them, and how fast the load
/// oscillates. Stores only sums per mode.
class Motion final {
 public:
  /// Limit of the share of coarse modes, explained in docs/plate.md.
  static constexpr double coarse_limit = 0.1;
  /// Results; NaN if not available.
  struct Evidence {
    static constexpr double unknown = std::numeric_limits<double>::quiet_NaN();
    /// Root mean square over mass and time of the oscillations of modes with less than ten steps per period,
    /// relative to the displacement without rigid motions.
    double coarse_share = unknown;
    int coarse_mode = 0;          ///< mode with the largest such oscillation, from 1
    double steps_a_period = 0;    ///< for that mode
    double recommended_step = 0;  ///< twenty steps per period of the highest mode that matters [s]
    /// Error of a mode near resonance due to its frequency error: 2 (error of the frequency) (amplification
    /// of the load's motion), times the mode's share of the displacement.
    double resonance_error = unknown;
    int resonant_mode = 0;
    double amplification = 0;          ///< of that mode
    double resonant_step = 0;          ///< step that reduces the error to a fifth of the limit [s]
    double last_mode_omega = unknown;  ///< highest mode with 1 % of the motion [1/s]
    /// Angular frequency of an oscillating load [1/s]: the smaller of pi times its reversals per second and
    /// of its rms rate of change over its rms. The second value is relative to the highest mode.
    double load_omega = unknown, load_over_last = unknown;
  };

  explicit Motion(std::span<const double> omega);

  /// Adds an accepted step of length `dt`. `load`: load on each mode in the step, without gravity and seat.
  void accepted(const ModalState& before, const ModalState& after, std::span<const double> load, double dt);
  /// `at_end`: nothing follows. Empty before a quarter of the longest period, because slow modes have not
  /// responded yet and fast ones dominate.
  Evidence evidence(bool at_end) const;
  /// Integral over time of the squared modal displacement [kg m^2 s].
  double moved(std::size_t mode) const { return modes_[mode].moved; }
  /// Data for checkpoints.
  template <class Numbers>
  void visit(Numbers& numbers) {
    numbers(time_, steps_, rigid_, modes_);
  }

 private:
  struct Mode {
    double omega = 0;
    // Integrals over time [kg m^2 s]: squared displacement, squared oscillation about the static response,
    // and the part of the latter in steps too long for it; longest of these steps [s].
    double moved = 0, swung = 0, coarse = 0, longest_step = 0;
    // During a changing load, integrals over time: squared rate, squared rate of the static response, time
    // step^2 times the former; number of steps; static displacement in the last step; largest change.
    double rate = 0, drive = 0, rate_step = 0, driven = 0, last_load = 0, largest_change = 0;
    // Static response over all steps: its integral, integrals of its square and of its squared change, number
    // of reversals, last counted change.
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
  double longest_period_ = 0;    // of a mode that is not a rigid motion
  double time_ = 0, rigid_ = 0;  // [s]; integral over time of squared rigid motions
  long steps_ = 0;
};

}  // namespace couplet::plate
