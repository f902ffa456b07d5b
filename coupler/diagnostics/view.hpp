// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <mpi.h>

#include <functional>
#include <memory>

#include "common/app/loop/step_loop.hpp"
#include "common/diagnostics/diagnostics.hpp"
#include "coupler/acceleration/fixed_point.hpp"
#include "coupler/output/record.hpp"
#include "coupler/parameters/schedule.hpp"
#include "coupler/pass.hpp"

namespace couplet::coupler {

/// View of a run that the coupler shows: its parts, as they are after the step just solved or accepted.
struct CouplingView {
  MPI_Comm comm;
  const CouplingParameters& parameters;
  const Pass& pass;
  const Unknown& unknown;
  const Record& record;
  const SchemeChoice& scheme;
  const FixedPointResult& last;  ///< of the step just solved
  const History& history;        ///< up to the step before
  const double& dt;              ///< of the last step [s]
};

/// A diagnostic that also looks into the passes of a step. What it learns there is of that step alone, unless the step is
/// accepted.
class CouplingDiagnostic : public diagnostics::Diagnostic {
 public:
  virtual void begin_step() {}
  /// Participant `side` has answered in a pass.
  virtual void answered(std::size_t /*side*/, const coupling::Exchange& /*taken*/,
                        const coupling::Exchange& /*given*/) {}
  /// A pass of an iteration is over; `omega` led to its x. Throws SolveFailure where the iteration runs away.
  virtual void passed(const std::vector<Residual>& /*residuals*/, double /*omega*/) {}
  /// Passes of explicit coupling, in a few steps: the pass from x gave `image`, another one from there `again`.
  virtual void returned(GlobalIndex /*step*/, const Iterate& /*x*/, const Iterate& /*image*/,
                        const Iterate& /*again*/) {}
  /// After a step that failed: why it did, if this diagnostic knows.
  virtual std::optional<app::StepFailure> suspects() const { return {}; }
  /// Said after the reason of a failed step whose cause nobody knows; empty: nothing.
  virtual std::string remark() const { return {}; }
  /// Why the run must not go on after the last accepted step; empty if it may.
  virtual std::string stop() const { return {}; }
};

using CouplingDiagnostics = std::vector<std::shared_ptr<CouplingDiagnostic>>;

/// All diagnostics of a coupling, in the order in which they are asked for the cause of a failure. `all` gets them, too.
CouplingDiagnostics coupling_diagnostics(const CouplingView& view, diagnostics::Diagnostics& all);

}  // namespace couplet::coupler
