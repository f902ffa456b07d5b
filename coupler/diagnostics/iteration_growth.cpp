// SPDX-License-Identifier: Apache-2.0
#include "coupler/diagnostics/guards.hpp"
#include "coupler/diagnostics/view.hpp"

namespace couplet::coupler {
namespace {

/// Ends an iteration that runs away within a few passes (see IterationGuard).
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

}  // namespace couplet::coupler
