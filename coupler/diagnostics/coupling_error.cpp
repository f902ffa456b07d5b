// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "common/io/archive.hpp"
#include "common/time/step_errors.hpp"
#include "coupler/diagnostics/view.hpp"

namespace couplet::coupler {
namespace {

// Of a residual that hardly falls nothing is known but that the error is large.
constexpr double slowest = 0.99;
// Where one pass was enough.
constexpr double unseen = 0.5;

/// What the iteration between participants leaves in the unknown below its tolerance: of a step whose residual fell
/// by the factor c in its last pass, |x - x*| <= c / (1 - c) |H(x) - x|; over all steps see StepErrors. Residuals
/// are over the size of the unknown.
class CouplingError final : public CouplingDiagnostic {
 public:
  explicit CouplingError(const CouplingView& view) : view_(view) {}
  void begin_step() override { residual_ = before_ = 0; }
  void passed(const Residual& residual, double) override {
    before_ = residual_;
    residual_ = residual.absolute;
  }
  void observe(diagnostics::Report&) override {
    const Iterate &before = view_.history.now, &now = view_.last.image;
    const Residual& last = view_.last.residual;
    if (before.unknown.size() != now.unknown.size() || !(last.relative > 0)) return;
    const double c = before_ > 0 ? std::min(residual_ / before_, slowest) : unseen;
    errors_.add({.error = c / (1 - c) * last.absolute,
                 .rate = worst(view_.unknown.measure(before, now)).absolute / view_.dt,
                 .size = last.absolute / last.relative,
                 .dt = view_.dt});
  }
  void conclude(diagnostics::Report& report) override { report.errors.coupling = errors_.over_size(); }
  void visit(io::Archive& archive) override { archive.common("steps", errors_); }

 private:
  const CouplingView& view_;
  double residual_ = 0, before_ = 0;  // of the last two passes of the step under way; 0: none
  time::StepErrors errors_;
};

}  // namespace

std::shared_ptr<CouplingDiagnostic> coupling_error(const CouplingView& view) {
  return view.pass.schedule().iterates ? std::make_shared<CouplingError>(view) : nullptr;
}

}  // namespace couplet::coupler
