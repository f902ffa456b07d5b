// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <filesystem>
#include <string>
#include <vector>

#include "common/coupling/participant.hpp"
#include "common/io/series.hpp"
#include "coupler/fixed_point.hpp"
#include "coupler/wiring.hpp"

namespace couplet {

/// The coupler's own output: residuals.csv (a row an iteration), balance.csv (a row a step), the console line
/// of each step and the closing summary.
class Monitor {
 public:
  /// restart_time: NaN for a fresh start.
  Monitor(const std::filesystem::path& folder, int dim, double end_time, double restart_time);

  void iteration(const Step& step, int number, const Residual& residual, double omega);
  void balance(double time, const Balance& fluid, const Balance& structure);
  /// `seconds`: spent in each participant over the step, by name; the first two work one after the other, the
  /// rest at the same time as the first.
  void step(const Step& step, double time, const FixedPointResult& result,
            const std::vector<std::pair<std::string, double>>& seconds);
  /// Mean and largest number of iterations, time by participant.
  std::string summary(int halvings) const;

 private:
  using Clock = std::chrono::steady_clock;
  Series residuals_, balance_;
  int dim_;
  double end_time_, start_time_;
  Clock::time_point start_ = Clock::now(), step_start_ = Clock::now();
  long steps_ = 0, iterations_ = 0, most_iterations_ = 0;
  std::vector<std::pair<std::string, double>> total_;
  double waited_ = 0;
};

}  // namespace couplet
