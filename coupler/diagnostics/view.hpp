// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <mpi.h>

#include <functional>
#include <memory>

#include "common/app/loop/step_loop.hpp"
#include "common/diagnostics/diagnostics.hpp"
#include "coupler/acceleration/accelerator.hpp"
#include "coupler/output/record.hpp"
#include "coupler/parameters/schedule.hpp"
#include "coupler/pass.hpp"

namespace couplet::coupler {

/// State of a coupled run after the last solved or accepted step, as diagnostics see it.
struct CouplingView {
  MPI_Comm comm;
  const CouplingParameters& parameters;
  const Pass& pass;
  const Unknown& unknown;
  const Record& record;
  const SchemeChoice& scheme;
  const FixedPointResult& last;  ///< of the last solved step
  const History& history;        ///< up to the previous step
  const double& dt;              ///< of the last step [s]
};

/// Diagnostic that also observes the passes of a step. What it learns there is discarded unless the step is
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
  /// Cause of a failed step, if this diagnostic knows it.
  virtual std::optional<app::StepFailure> suspects() const { return {}; }
  /// Remark after the reason of a failed step of unknown cause; may be empty.
  virtual std::string remark() const { return {}; }
  /// Reason to stop after the last accepted step; empty to continue.
  virtual std::string stop() const { return {}; }
};

using CouplingDiagnostics = std::vector<std::shared_ptr<CouplingDiagnostic>>;

/// Creates all diagnostics of a coupling in the order of their causes, and adds them to `all`.
CouplingDiagnostics coupling_diagnostics(const CouplingView& view, diagnostics::Diagnostics& all);

}  // namespace couplet::coupler
