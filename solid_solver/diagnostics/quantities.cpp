// SPDX-License-Identifier: Apache-2.0
#include "solid_solver/output/quantities.hpp"

#include <fmt/format.h>
#include <cmath>

#include "common/base/error.hpp"
#include "common/diagnostics/results.hpp"
#include "common/log/log.hpp"
#include "common/parallel/collective.hpp"
#include "solid_solver/diagnostics/strain_energy.hpp"
#include "solid_solver/diagnostics/view.hpp"

namespace couplet::solid {
namespace {

template <class Estimate>
std::vector<QuantityEstimate> estimates_of(const Estimate& estimate) {
  try {
    return estimate();
  } catch (const SolveFailure& failure) {
    log::warn("quantities: the estimate failed: {}", failure.what());
    return {};
  }
}

/// Quantities of interest with their mesh errors.
class Quantities final : public diagnostics::Diagnostic {
 public:
  explicit Quantities(const SolidView& view) : view_(view) {}
  /// Computed while the solver of the state is still available.
  void observe(diagnostics::Report&) override {
    if (view_.stepper.step().is_last) estimate();
  }
  void conclude(diagnostics::Report&) override {
    if (!view_.stepper.step().is_last) estimate();  // a partner's load may be the last
    const double stiff = found_.empty() ? 0 : audit_strain(view_, true).inner_variation;
    for (QuantityEstimate& q : found_) q.body = stiff * std::abs(q.value);
    tell_quantities(view_.comm(), view_.context, found_);
  }

 private:
  void estimate() {
    SolutionMethod* method = view_.stepper.method();
    if (method && !view_.body.parameters().quantities.empty())
      found_ =
          estimates_of([&] { return estimate_quantities(view_.body, view_.fields, view_.now(), *method); });
  }

  SolidView view_;
  std::vector<QuantityEstimate> found_;
};

/// Quantities of interest of a steady temperature.
class QuantitiesOfHeat final : public diagnostics::Diagnostic {
 public:
  explicit QuantitiesOfHeat(const HeatView& view) : view_(view) {}
  void conclude(diagnostics::Report&) override {
    if (view_.heat.accepted().steps == 0) return;
    const auto estimate = [&] { return estimate_heat_quantities(view_.heat, view_.parameters.quantities); };
    tell_quantities(view_.heat.conduction().mesh().comm, view_.context, estimates_of(estimate));
  }

 private:
  HeatView view_;
};

}  // namespace

diagnostics::Made quantities(const SolidView& view) { return std::make_shared<Quantities>(view); }

diagnostics::Made quantities(const HeatView& view) {
  if (view.parameters.quantities.empty()) return nullptr;
  return std::make_shared<QuantitiesOfHeat>(view);
}

namespace {

// Relative error above which a probed stress is reported as doubtful.
constexpr double doubtful = 0.3;

/// Stresses at probes and, in static runs, the largest one, with their errors.
class StressError final : public diagnostics::Diagnostic {
 public:
  explicit StressError(const SolidView& view) : view_(view) {}
  void conclude(diagnostics::Report&) override {
    if (view_.now().steps == 0) return;
    for (const ReportedStress& s : reported_stresses(view_.body, view_.fields, view_.output.probes()))
      tell(s);
  }

 private:
  /// Most are notes, which diagnostics do not report.
  void tell(const ReportedStress& s) const {
    const bool is_doubtful = s.where != "largest" && s.error > doubtful;
    const std::string error = std::isnan(s.error) ? "unknown"
                              : s.error < 0.995   ? fmt::format("{:.2g} %", 100 * s.error)
                                                  : fmt::format("{:.0f} %", 100 * s.error);
    if (parallel::comm_rank(view_.comm()) == 0)
      diagnostics::set_result(
          {"equivalent stress, " + s.where, "Pa", {s.value}, s.error, diagnostics::place_text(s.place)});
    diagnostics::finding(
        parallel::comm_rank(view_.comm()),
        {.id = "stress-error",
         .severity = is_doubtful ? base::Severity::warning : base::Severity::note,
         .number = s.error,
         .limit = doubtful,
         .sentence =
             fmt::format("equivalent stress, {}: {:.4g} Pa at ({:g}, {:g}, {:g}) m, estimated error {}{}",
                         s.where, s.value, s.place[0], s.place[1], s.place[2], error,
                         is_doubtful ? fmt::format(" (limit {:.2g} %): not reliable", 100 * doubtful) : ""),
         .advice = is_doubtful ? "refine the mesh there" : ""});
  }

  SolidView view_;
};

}  // namespace

diagnostics::Made stress_error(const SolidView& view) { return std::make_shared<StressError>(view); }

}  // namespace couplet::solid
