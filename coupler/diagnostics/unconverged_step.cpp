// SPDX-License-Identifier: Apache-2.0
#include "coupler/diagnostics/view.hpp"

namespace couplet::coupler {
namespace {

// Of the motion: a step that leaves more is no solution of the coupled problem.
constexpr double useless_residual = 0.5;

/// Steps that `at-max-iterations: accept` takes although they have not converged.
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

}  // namespace couplet::coupler
