// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <deque>

namespace couplet::fluid {

/// Detects whether a signal is periodic: its last maxima, or every second or third one, are equally spaced
/// and high. A maximum counts if the signal then falls by a tenth of its recent range, so noise is ignored.
class Repetition {
 public:
  /// Adds a value `dt` [s] after the previous one.
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
  Peak extreme_;                  // largest value since the last minimum, or smallest since the last maximum
  bool rises_ = true;             // extreme_ is a largest value
  double time_ = 0, dt_ = 0;      // since the first value; longest step [s]
  double upper_ = 0, lower_ = 0;  // recent envelope
};

/// Estimates the phase error of a self-excited periodic flow, such as a vortex street without driving walls
/// or clocks. The flow damps step errors across its cycle but not along it. A step with the error w dt u'''
/// shifts the phase by the fraction -w <u''', u'>/<u', u'> = w |u''|^2/|u'|^2 of a step, with means over a
/// cycle. For a single frequency and Adams-Bashforth this is 5/12 (omega dt)^2. After a time t, the phase and
/// velocity errors are
///   d = t w |u''|^2 / |u'|^2   and   d |u'|, at most twice the amplitude |u'|^2 / |u''|.
class PhaseDrift {
 public:
  /// Adds a step of `dt` [s]: kinetic energy, norms of rate and change of rate [m/s^2, m/s^3], weight w
  /// [s^2].
  void add(double dt, double energy, double rate, double change, double weight);
  /// Velocity error [m/s]; 0 if the flow is not periodic.
  double error() const;
  template <class Numbers>
  void visit(Numbers& numbers) {
    numbers(repetition_, time_, rate_, change_, weighted_);
  }

 private:
  Repetition repetition_;
  double time_ = 0;                              // [s]
  double rate_ = 0, change_ = 0, weighted_ = 0;  // recent means of squares; last: change^2 times weight
};

}  // namespace couplet::fluid
