// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "common/io/checkpoint.hpp"
#include "common/time/step_errors.hpp"
#include "coupler/diagnostics/guards.hpp"
#include "coupler/diagnostics/view.hpp"

namespace couplet::coupler {
namespace {

/// Stops a diverging iteration within a few passes (see IterationGuard).
class IterationGrowth final : public CouplingDiagnostic {
 public:
  explicit IterationGrowth(const CouplingView& view) : view_(view) {}
  void begin_step() override { guard_.start_step(); }
  void passed(const Residual& residual, double omega) override {
    if (!converged(residual, view_.parameters.convergence))
      guard_.pass(residual.absolute, omega, is_constant());
  }
  std::optional<app::StepFailure> suspects() const override {
    const double omega = view_.parameters.acceleration.initial_relaxation;
    if (const auto grew = guard_.suspects(is_constant() ? omega : 0))
      return app::StepFailure(*grew, !is_constant());
    return {};
  }

 private:
  bool is_constant() const {
    return view_.parameters.acceleration.type == AccelerationParameters::Type::constant;
  }

  const CouplingView& view_;
  IterationGuard guard_;
};

}  // namespace

std::shared_ptr<CouplingDiagnostic> iteration_growth(const CouplingView& view) {
  return view.pass.schedule().iterates ? std::make_shared<IterationGrowth>(view) : nullptr;
}

namespace {

// Relative residual above which a step does not solve the coupled problem.
constexpr double useless_residual = 0.5;

/// Reports steps accepted without convergence (`at-max-iterations: accept`).
class UnconvergedStep final : public CouplingDiagnostic {
 public:
  explicit UnconvergedStep(const CouplingView& view) : view_(view) {}
  void observe(diagnostics::Report& report) override {
    const FixedPointResult& last = view_.last;
    if (last.converged) return;
    const ConvergenceParameters& wanted = view_.parameters.convergence;
    const double residual = last.residual.relative;
    report.findings.push_back(
        {.id = "unconverged-step",
         .severity = residual < useless_residual ? base::Severity::warning : base::Severity::wrong,
         .number = residual,
         .limit = wanted.relative,
         .sentence =
             fmt::format("coupling: relative residual = {:.2e} (limit {:.1e}){} after {} iterations: "
                         "the step is accepted unconverged",
                         residual, wanted.relative, absolute_too(last.residual, wanted), last.iterations),
         .advice = "raise `convergence.max-iterations`, or leave `at-max-iterations: accept` out"});
  }

 private:
  const CouplingView& view_;
};

}  // namespace

std::shared_ptr<CouplingDiagnostic> unconverged_step(const CouplingView& view) {
  return view.pass.schedule().iterates ? std::make_shared<UnconvergedStep>(view) : nullptr;
}

namespace {

// Contraction above which the residual only shows that the error is large.
constexpr double slowest = 0.99;
// Contraction assumed if one pass was enough.
constexpr double unseen = 0.5;

/// Error of the iteration between participants below its tolerance. If the last pass reduced the residual by
/// a factor c,
/// |x - x*| <= c/(1 - c) |H(x) - x|; for all steps see StepErrors. Residuals are relative to the unknown.
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
  double residual_ = 0, before_ = 0;  // of the last two passes of this step; 0 if none
  time::StepErrors errors_;
};

}  // namespace

std::shared_ptr<CouplingDiagnostic> coupling_error(const CouplingView& view) {
  return view.pass.schedule().iterates ? std::make_shared<CouplingError>(view) : nullptr;
}

}  // namespace couplet::coupler
