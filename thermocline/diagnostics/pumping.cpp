// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include "thermocline/diagnostics/tank_diagnostic.hpp"

namespace couplet::thermocline {
namespace {

/// Power of pump or fan at the largest flow, over the heat flow between the coldest and hottest fluid.
class Pumping final : public TankDiagnostic {
 public:
  using TankDiagnostic::TankDiagnostic;
  void look(diagnostics::Report& report) override {
    const auto [cold, hot] = range_to_come();
    if (!(seen_->flow > 0) || hot <= cold + 1) return;
    if (view_.parameters().pump)
      look_at_pump(report, cold, hot);
    else
      look_at_neglected(report, cold, hot);
  }
  void conclude(diagnostics::Report& report) override {
    if (view_.parameters().pump || !(seen_->flow > 0)) return;
    const PressureLoss loss =
        pressure_loss(bed().grid(), view_.fluid(), bed().fluid(), seen_->flow, bed().area());
    report.sentences.push_back(fmt::format(
        "pressure: the bed's loss of {:.3g} kPa at the largest flow, {:.3g} kW of a pump, was neglected (pump)",
        1e-3 * loss.loss(),
        1e-3 * pump_power(loss, view_.fluid(), bed().bottom(), seen_->flow, usual_efficiency)));
  }

 private:
  static constexpr double usual_efficiency = 0.7;

  /// Ergun at the mean of both temperatures, layer by layer.
  void look_at_neglected(diagnostics::Report& report, double cold, double hot) const {
    const Fluid& f = view_.fluid();
    const double mean = 0.5 * (cold + hot);
    const double density = f.is_gas() ? f.pressure / (f.gas_constant * mean) : f.density;
    double loss = 0;
    for (const auto& run : bed().grid().runs)
      if (run.layer.porosity < 1)
        loss += run.layer.height * ergun(run.layer, f.viscosity(mean), seen_->flow / bed().area()) / density;
    const double share = loss / (density * usual_efficiency * f.specific_heat * (hot - cold));
    tell(report, {.effect = "pressure loss of the bed",
                  .number = share,
                  .limit = 0.02,
                  .what = fmt::format(
                      "pressure loss of {:.3g} kPa at the largest flow: {:.2g} of the transported heat",
                      1e-3 * loss, share),
                  .advice = "add 'pump: {}', or check flow and grains: no real store is driven this hard",
                  .share = share});
  }

  /// A power block converts some 0.4 of the heat, and pump or fan run during charge and discharge: a tenth of
  /// the heat is half of the electricity sold. The bed is assumed at the mean temperature.
  void look_at_pump(diagnostics::Report& report, double cold, double hot) const {
    const Fluid& f = view_.fluid();
    const std::vector<double> mean(std::size_t(bed().grid().size()), 0.5 * (cold + hot));
    const PressureLoss loss = pressure_loss(bed().grid(), f, mean, seen_->flow, bed().area());
    const double power = pump_power(loss, f, cold, seen_->flow, view_.parameters().pump->efficiency),
                 heat = seen_->flow * f.specific_heat * (hot - cold);
    tell(report,
         {.effect = "work of pump or fan",
          .number = power / heat,
          .limit = 0.1,
          .what =
              fmt::format("pump or fan {:.3g} MW / transported heat {:.3g} MW = {:.2g} at the largest flow",
                          1e-6 * power, 1e-6 * heat, power / heat),
          .advice = "they consume half of the electricity or more: use less flow, a wider or lower bed, or "
                    "larger grains",
          .left_out = false});
  }
};

}  // namespace

Made pumping(const TankView& view, const Seen& seen) { return std::make_shared<Pumping>(view, seen); }

}  // namespace couplet::thermocline
