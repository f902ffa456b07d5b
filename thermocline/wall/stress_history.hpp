// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

namespace couplet::thermocline {

/// Which share of its yield strength each ring of the wall carried: daily extremes, their sums, the largest
/// of all. As many numbers as rings, however long the run.
///
/// The factors of safety compare stress and strength at the same moment, because the strength falls with
/// temperature: with s = sigma_eq / sigma_y(T), FoS_static = 1 / max s (5.21) and, with the means of the
/// daily extremes, FoS_dynamic = (1 - s_min) / (s_max - s_min) (5.22 divided by the strength).
class StressHistory {
 public:
  /// `counts`: the day belongs to the results; otherwise it is looked at but not kept.
  void see(double time, std::span<const double> z, std::span<const double> equivalent,
           std::span<const double> yield);
  void end_day(bool counts);

  struct Factor {
    double value = 0;
    double z = 0;     ///< centre of the ring [m]
    double time = 0;  ///< [s]; of the static factor only
  };
  bool empty() const { return days_ == 0 || z_.empty(); }
  Factor static_factor() const;
  Factor dynamic_factor() const;
  std::span<const double> z() const { return z_; }
  /// Means of the daily extremes of sigma_eq / sigma_y, ring by ring, and the largest of all.
  std::vector<double> mean_lowest() const { return mean(sum_lowest_); }
  std::vector<double> mean_highest() const { return mean(sum_highest_); }
  std::span<const double> highest() const { return highest_; }

  std::vector<double> state() const;
  /// How many numbers state() gives of so many rings, its first one.
  static double state_size(double rings) { return 3 + 8 * rings; }
  /// Takes what state() gave from the front of `state` and leaves the rest.
  void restore(std::span<const double>& state);

 private:
  std::vector<double> mean(const std::vector<double>& sum) const;

  std::vector<double> z_, day_lowest_, day_highest_, day_highest_at_;
  std::vector<double> sum_lowest_, sum_highest_, highest_, highest_at_;
  bool day_begun_ = false;
  int days_ = 0;
};

}  // namespace couplet::thermocline
