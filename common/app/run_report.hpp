// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <mpi.h>

#include <filesystem>
#include <functional>
#include <optional>
#include <string>

#include "common/app/job.hpp"
#include "common/coupling/participant.hpp"
#include "common/diagnostics/choices.hpp"
#include "common/diagnostics/diagnostics.hpp"
#include "common/diagnostics/error_parts.hpp"
#include "common/io/series.hpp"

namespace couplet::app {

struct Job;

/// Files of a run for scripts and studies, beside its results:
///   steps.csv  a row per accepted step: time and dt [s], iterations of linear solvers, estimated time error
///              of the step [1], energy [J], seconds; nan if not computed. Disabled by output.steps.
///   run.json   at the end: outcome, wall and processor seconds, memory, steps, iterations, phases,
///              results (see diagnostics::Result), estimated error contributions (null: unknown), position in
///              the atlas, findings with ids.
/// Written by rank 0. A run.json of an earlier run is removed at the start.
class RunReport {
 public:
  /// `with_steps` writes steps.csv unless the case disables it.
  explicit RunReport(const Job& job, bool with_steps = true);
  /// Adds seconds spent on the current step, including failed attempts. `processor` is user and system time
  /// of this process.
  void spent(double seconds, double processor) {
    since_accepted_ += seconds;
    working_ += processor;
  }
  /// Records a step that ended at `time` [s]. Sets report.seconds to the time spent since the last call.
  void accepted(double time, coupling::StepReport report);
  /// Records all steps at once, for programs that count them elsewhere.
  void total(double time, long steps, long iterations) {
    time_ = time, count_ = steps, iterations_ = iterations;
  }
  /// Writes run.json. `wall` [s]; `problem`: why the run ended early, or empty. Collective over job.comm.
  void finish(double wall, const std::string& problem, const diagnostics::ErrorParts& errors,
              const std::vector<diagnostics::Coordinate>& position);

  /// End of the last accepted step [s], or the start of the run.
  double time() const { return time_; }

  /// User and system time of this process since it started.
  static double processor_seconds();
  /// Peak memory of this process [MB], or 0 if unknown.
  static double peak_memory();

 private:
  const Job& job_;
  std::optional<io::Series> steps_;
  double since_accepted_ = 0, working_ = 0, time_;
  long count_ = 0, iterations_ = 0;
};

/// Adds the diagnostics of an initialized participant; empty if it has none.
using Diagnose = std::function<void(coupling::Participant&, diagnostics::Diagnostics&)>;

/// Runs the participant alone from start to end. Returns the exit code.
int run_alone(const Job& job, coupling::Participant& participant, const Diagnose& diagnose = {});

/// Runs the participant under a coupler's commands until it is told to finalize.
int run_coupled(const Job& job, MPI_Comm coupler, coupling::Participant& participant,
                const Diagnose& diagnose = {});

/// Judges what the case gives by what it did in the run (fv::uses): loads, inlets, bodies and tables that never
/// acted, values that no step sees, and those outside a table or the usual range.
diagnostics::Made use_of_case(MPI_Comm comm);

}  // namespace couplet::app
