// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <limits>
#include <span>
#include <vector>

#include "plate_modal/motion/oscillators.hpp"

namespace couplet::plate {

/// Collects over the steps which modes move, and how fast the load oscillates. Stores only sums per mode.
class Motion final {
 public:
  /// Angular frequency of an oscillating load [1/s]: the smaller of pi times its reversals per second and of
  /// its rms rate of change over its rms. The second value is relative to the highest mode. NaN if it does
  /// not oscillate.
  struct LoadFrequency {
    double omega = std::numeric_limits<double>::quiet_NaN(), over_last = omega;
  };

  explicit Motion(std::span<const double> omega);

  /// Adds an accepted step of length `dt`. `load`: load on each mode in the step, without gravity and seat.
  void accepted(const ModalState& before, const ModalState& after, std::span<const double> load, double dt);
  /// `at_end`: nothing follows. NaN before a quarter of the longest period, because slow modes have not
  /// responded yet.
  LoadFrequency load_frequency(bool at_end) const;
  /// Integral over time of the squared modal displacement [kg m^2 s].
  double moved(std::size_t mode) const { return modes_[mode].moved; }
  /// Data for checkpoints.
  template <class Numbers>
  void visit(Numbers& numbers) {
    numbers(time_, steps_, modes_);
  }

 private:
  struct Mode {
    double omega = 0;
    double moved = 0;  // integral over time of the squared displacement [kg m^2 s]
    // Static response over all steps: in the last step, its largest change, its integral, integrals of its
    // square and of its squared change, number of reversals, last counted change.
    double last_load = 0, largest_change = 0, load = 0, load_square = 0, change = 0, turns = 0,
           last_change = 0;
    template <class Numbers>
    void visit(Numbers& numbers) {
      numbers(omega, moved, last_load, largest_change, load, load_square, change, turns, last_change);
    }
  };

  void follow(Mode& mode, double load, double dt) const;

  std::vector<Mode> modes_;
  double longest_period_ = 0;  // of a mode that is not a rigid motion
  double time_ = 0;            // [s]
  long steps_ = 0;
};

}  // namespace couplet::plate
