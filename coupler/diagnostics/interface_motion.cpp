// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "common/io/checkpoint.hpp"
#include "coupler/diagnostics/guards.hpp"
#include "coupler/diagnostics/view.hpp"

namespace couplet::coupler {
namespace {

using OnDivergence = CouplingParameters::OnDivergence;

/// Detects a growing oscillation of the interface from step to step (see OscillationGuard).
class InterfaceOscillation final : public CouplingDiagnostic {
 public:
  explicit InterfaceOscillation(const CouplingView& view)
      : view_(view), guard_(view.comm, view.parameters.convergence.relative) {}
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
    // Halving does not help a step that already oscillates.
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

/// Compares the work given and taken at the interface (see WorkGuard).
class InterfaceWork final : public CouplingDiagnostic {
 public:
  explicit InterfaceWork(const CouplingView& view) : view_(view) {}
  void observe(diagnostics::Report&) override {
    double given = 0, taken = 0;
    if (view_.record.balances().empty()) return;
    for (const SideBalance& side : view_.record.balances()) (side.gives ? given : taken) += side.balance.work;
    guard_.energy(energy_of_structures());
    guard_.accepted(given, taken);
  }
  void conclude(diagnostics::Report& report) override {
    const WorkGuard::Verdict v = guard_.verdict(
        view_.parameters.mapping.type == MappingParameters::Type::nearest, !view_.pass.schedule().iterates);
    if (v.text.empty()) return;
    if (v.sound)
      report.sentences.push_back(v.text);
    else
      report.findings.push_back({.id = "interface-work",
                                 .severity = v.useless ? base::Severity::wrong : base::Severity::warning,
                                 .number = v.part,
                                 .limit = WorkGuard::sound_part,
                                 .sentence = v.text});
  }
  void visit(io::Archive& archive) override { archive.common("work", guard_); }

 private:
  /// Energy in the accepted state of all participants that take forces [J]; NaN if one does not report it.
  double energy_of_structures() const {
    double total = 0;
    for (std::size_t i = 0; i < view_.pass.sides().size(); ++i) {
      const auto& takes = view_.pass.sides()[i].interface.takes;
      if (std::ranges::find(takes, "N", &coupling::Interface::Datum::unit) != takes.end())
        total += view_.pass.partners()[i].report.energy;
    }
    return total;
  }

  const CouplingView& view_;
  WorkGuard guard_;
};

}  // namespace

std::shared_ptr<CouplingDiagnostic> interface_oscillation(const CouplingView& view) {
  return std::make_shared<InterfaceOscillation>(view);
}

std::shared_ptr<CouplingDiagnostic> interface_work(const CouplingView& view) {
  return view.record.mechanics().knows_work() ? std::make_shared<InterfaceWork>(view) : nullptr;
}

}  // namespace couplet::coupler
