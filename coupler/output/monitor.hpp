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
#include "coupler/acceleration/fixed_point.hpp"
#include "coupler/exchange/partners.hpp"
#include "coupler/parameters/schedule.hpp"

namespace couplet::coupler {

/// The coupler's own output, by its rank 0: residuals.csv (a row a pass), participants.csv (a row a step:
/// what each worked and waited, what it says of its step, the coupler's own work), balance.csv (forces, moments and work),
/// amounts.csv (sums that go over), volume.csv (levels of closed fluids), watch.csv (integrals asked for), the console line of
/// each step and the closing summary.
class Monitor {
 public:
  /// `names`: of everyone. `restart_time`: NaN for a fresh start.
  Monitor(MPI_Comm comm, std::filesystem::path folder, std::vector<std::string> names, double end_time,
          double restart_time);
  /// The first step begins now: what went before is not its work.
  void start(const std::vector<Partner>& partners);
  void iteration(const coupling::Step& step, int number, const Residual& residual, double omega);
  /// One row of a table that is begun with its first row; nothing without columns.
  void row(const char* file, double time, const std::vector<std::string>& columns,
           const std::vector<double>& values);
  void step(const coupling::Step& step, double time, const FixedPointResult& result,
            const std::vector<Partner>& partners);
  /// Mean and largest number of iterations, time by participant.
  std::string summary(int halvings) const;
  /// Who waited for whom, and how ranks are better divided; may be empty.
  std::string waiting(const std::vector<Partner>& partners, const Schedule& schedule) const;

 private:
  using Clock = std::chrono::steady_clock;
  std::filesystem::path folder_;
  bool writes_;
  std::vector<std::string> names_;
  std::optional<io::Series> residuals_, participants_;
  std::map<std::string, io::Series> tables_;  // begun so far
  double end_time_, restart_time_, start_time_;
  Clock::time_point start_ = Clock::now(), step_start_ = Clock::now(), last_line_{};
  long steps_ = 0, iterations_ = 0, most_iterations_ = 0;
  std::vector<double> worked_;  // seconds of each over the run
  double wall_ = 0;
  double own_ = 0,
         own_before_ = 0;  // processor seconds of the coupler: of the run, up to this step since it began
};

/// Work of a participant in a run.
struct Worker {
  std::string name;
  int ranks = 1;
  double seconds = 0;  ///< of wall time at work, on these ranks
};

/// `total` ranks for them, one at least for each. Work is taken to divide by the ranks. One after another (Gauss-Seidel) the
/// times add up: the sum of work / ranks is the least that whole numbers allow; side by side the longest of them is.
std::vector<int> divide_ranks(const std::vector<Worker>& workers, int total, bool side_by_side);

/// For the end of a run: who waited for whom, and, where another division of the same ranks would take a tenth less time, that
/// one; with one rank each, whose the next rank should be. Empty: one participant, or no work was measured.
std::string waiting_sentence(const std::vector<Worker>& workers, bool side_by_side);

}  // namespace couplet::coupler
