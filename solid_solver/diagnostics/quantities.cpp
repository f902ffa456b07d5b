// SPDX-License-Identifier: Apache-2.0
#include "solid_solver/output/quantities.hpp"

#include <cmath>

#include "common/base/error.hpp"
#include "common/log/log.hpp"
#include "solid_solver/diagnostics/strain_energy.hpp"
#include "solid_solver/diagnostics/view.hpp"
#include "solid_solver/output/heat_quantities.hpp"

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

}  // namespace couplet::solid
