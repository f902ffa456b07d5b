// SPDX-License-Identifier: Apache-2.0
#include "common/io/archive.hpp"
#include "coupler/diagnostics/guards.hpp"
#include "coupler/diagnostics/view.hpp"

namespace couplet::coupler {
namespace {

using OnDivergence = CouplingParameters::OnDivergence;

/// The interface swings from step to step and more and more (see OscillationGuard).
class InterfaceOscillation final : public CouplingDiagnostic {
 public:
  explicit InterfaceOscillation(const CouplingView& view) : view_(view), guard_(view.comm) {}
  void observe(diagnostics::Report& report) override {
    const auto reason = guard_.accepted(view_.unknown.motion(view_.last.image), view_.dt, view_.scheme.now());
    if (!reason) return;
    if (stops())
      stop_ = *reason;
    else
      report.findings.push_back(
          {.id = "interface-oscillation", .severity = base::Severity::wrong, .sentence = *reason});
  }
  std::optional<app::StepFailure> suspects() const override {
    // What swings already is not saved by halving.
    if (const auto swings = guard_.suspects(view_.scheme.now()); swings && stops())
      return app::StepFailure(*swings, false);
    return {};
  }
  std::string stop() const override { return stop_; }
  void visit(io::Archive& archive) override {
    guard_.visit_numbers(archive);
    std::size_t first = 0;
    for (const Unknown::Part& part : view_.unknown.parts()) {
      if (part.datum.name != "displacement") continue;
      const Side& side = view_.pass.sides()[part.giver];
      const std::string name = "motion-" + std::to_string(first);
      guard_.visit_fields(archive, side.order(view_.comm, part.datum.place), name, first, part.count,
                          std::size_t(part.components));
      first += part.count;
    }
  }

 private:
  bool stops() const { return view_.parameters.on_divergence == OnDivergence::stop; }

  const CouplingView& view_;
  OscillationGuard guard_;
  std::string stop_;
};

}  // namespace

std::shared_ptr<CouplingDiagnostic> interface_oscillation(const CouplingView& view) {
  return std::make_shared<InterfaceOscillation>(view);
}

}  // namespace couplet::coupler
