// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <deque>

namespace couplet::fluid {

/// Whether a signal repeats itself: its last maxima come at equal distances and are equally high, or every second, or every third
/// of them. A maximum counts if the signal falls after it by a tenth of its swing of late, so noise makes none.
class Repetition {
 public:
  /// A value `dt` [s] after the last one.
  void add(double dt, double value);
  bool repeats() const;
  template <class Numbers>
  void visit(Numbers& numbers) {
    numbers(peaks_, extreme_, rises_, time_, dt_, upper_, lower_);
  }

 private:
  struct Peak {
    double time = 0, height = 0;
    template <class Numbers>
    void visit(Numbers& numbers) {
      numbers(time, height);
    }
  };
  bool repeats_after(std::size_t peaks) const;
  std::deque<Peak> peaks_;        // the last ones, oldest first
  Peak extreme_;                  // highest since the last minimum, or lowest since the last maximum
  bool rises_ = true;             // it is the highest
  double time_ = 0, dt_ = 0;      // since the first value; longest step [s]
  double upper_ = 0, lower_ = 0;  // envelope of late
};

/// How far a flow that repeats itself by its own law (a vortex street, no clock and no wall that drives it) is out of step. What a
/// step leaves across its cycle is taken away by the flow, along it by nothing: the phase. A scheme whose step leaves w dt u''' moves the
/// flow along its cycle by the share -w <u''', u'> / <u', u'> = w |u''|^2 / |u'|^2 of a step, means over a cycle (for a single frequency
/// 5/12 (omega dt)^2 with Adams and Bashforth), so after a time t by
///   d = t w |u''|^2 / |u'|^2,   and the velocity by d |u'|,
/// at most by twice the amplitude |u'|^2 / |u''|.
class PhaseDrift {
 public:
  /// Of a step of `dt` [s]: kinetic energy, the norms of the rate and of its change [m/s^2, m/s^3], the weight [s^2].
  void add(double dt, double energy, double rate, double change, double weight);
  /// In the velocity [m/s]; 0: the flow does not repeat itself.
  double error() const;
  template <class Numbers>
  void visit(Numbers& numbers) {
    numbers(repetition_, time_, rate_, change_, weighted_);
  }

 private:
  Repetition repetition_;
  double time_ = 0;  // [s]
  double rate_ = 0, change_ = 0,
         weighted_ = 0;  // means of late of the squares; of the latter's times the weight
};

}  // namespace couplet::fluid
