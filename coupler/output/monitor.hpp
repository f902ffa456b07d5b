// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <mpi.h>

#include <chrono>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "common/coupling/participant.hpp"
#include "common/io/series.hpp"
#include "coupler/acceleration/accelerator.hpp"
#include "coupler/exchange/partners.hpp"
#include "coupler/parameters/schedule.hpp"

namespace couplet::coupler {

/// Output of the coupler by rank 0: residuals.csv (per pass), participants.csv (per step: working and waiting
/// times, reports, the coupler's own time), balance.csv (forces, moments, work), amounts.csv (transferred
/// sums), volume.csv (levels of closed fluids), watch.csv (requested integrals), the console line of each
/// step and the closing summary.
class Monitor {
 public:
  /// `names`: names of all participants. `restart_time`: NaN for a fresh start.
  Monitor(MPI_Comm comm, std::filesystem::path folder, std::vector<std::string> names, double end_time,
          double restart_time);
  /// Starts the clock of the first step; earlier work is not counted.
  void start(const std::vector<Partner>& partners);
  void iteration(const coupling::Step& step, int number, const Residual& residual, double omega);
  /// Adds a row to a table, which is opened with its first row; nothing without columns.
  void row(const char* file, double time, const std::vector<std::string>& columns,
           const std::vector<double>& values);
  void step(const coupling::Step& step, double time, const FixedPointResult& result,
            const std::vector<Partner>& partners);
  /// Mean and largest number of iterations, and time per participant.
  std::string summary(int halvings) const;
  /// Mean and largest number.
  std::vector<double> iterations_per_step() const {
    return {double(iterations_) / double(std::max(1L, steps_)), double(most_iterations_)};
  }
  /// See waiting_sentence().
  std::string waiting(const std::vector<Partner>& partners, const Schedule& schedule) const;

 private:
  using Clock = std::chrono::steady_clock;
  std::filesystem::path folder_;
  bool writes_;
  std::vector<std::string> names_;
  std::optional<io::Series> residuals_, participants_;
  std::map<std::string, io::Series> tables_;  // opened so far
  double end_time_, restart_time_, start_time_;
  Clock::time_point start_ = Clock::now(), step_start_ = Clock::now(), last_line_{};
  long steps_ = 0, iterations_ = 0, most_iterations_ = 0;
  std::vector<double> worked_;  // seconds per participant over the run
  double wall_ = 0;
  double own_ = 0, own_before_ = 0;  // CPU seconds of the coupler: total, and up to this step
};

/// Names the participant for which the others wait, from their times at work [s]. Empty for one participant or
/// a short run. `couplet run -n TOTAL` divides the ranks by the work of the last run.
std::string waiting_sentence(const std::vector<std::string>& names, const std::vector<double>& seconds,
                             bool side_by_side);

}  // namespace couplet::coupler
