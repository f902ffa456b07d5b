// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <mpi.h>

#include <filesystem>
#include <optional>
#include <string>

#include "common/coupling/participant.hpp"
#include "common/diagnostics/diagnostics.hpp"
#include "common/diagnostics/effects.hpp"
#include "common/diagnostics/error_parts.hpp"
#include "common/io/series.hpp"

namespace couplet::app {

struct Job;

/// What a run leaves for scripts and studies, beside its results:
///   steps.csv  a row an accepted step: time and dt [s], iterations of linear solvers, estimated time error
///              of the step [1], energy [J], seconds; what was not computed is nan. Off with output.steps.
///   run.json   at the end: how it ended, wall and processor seconds, memory, steps, iterations, phases,
///              estimated parts of the error (null: not known), where the run stands on the atlas, findings with
///              their ids.
/// Written by rank 0. The file of an earlier run is removed at the start: a run.json speaks of this run.
class RunReport {
 public:
  /// `with_steps`: steps.csv, unless the case does not want it.
  explicit RunReport(const Job& job, bool with_steps = true);
  /// Adds seconds spent on the step under way, failed attempts included.
  /// `processor`: user and system seconds of this process among them.
  void spent(double seconds, double processor) {
    since_accepted_ += seconds;
    working_ += processor;
  }
  /// `time`: the end of the step [s]; report.seconds is replaced by those spent since the last call.
  void accepted(double time, coupling::StepReport report);
  /// In place of accepted(): all steps of the run at once, for who keeps the steps otherwise.
  void total(double time, long steps, long iterations) {
    time_ = time, count_ = steps, iterations_ = iterations;
  }
  /// Collective over job.comm. `wall` [s]; `problem`: why the run ended early, empty if it did not.
  void finish(double wall, const std::string& problem, const diagnostics::ErrorParts& errors,
              const std::vector<diagnostics::Coordinate>& position);

  /// User and system seconds of this process since it began.
  static double processor_seconds();
  /// Most memory this process has had in use [MB]; 0 where the system does not tell.
  static double peak_memory();

 private:
  const Job& job_;
  std::optional<io::Series> steps_;
  double since_accepted_ = 0, working_ = 0, time_ = 0;
  long count_ = 0, iterations_ = 0;
};

}  // namespace couplet::app
