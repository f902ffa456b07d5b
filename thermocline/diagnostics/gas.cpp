// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "thermocline/diagnostics/tank_diagnostic.hpp"

namespace couplet::thermocline {
namespace {

/// Checks an ideal gas of constant specific heat: its Mach number, and the mean of the true specific heat.
class Gas final : public TankDiagnostic {
 public:
  using TankDiagnostic::TankDiagnostic;
  void look(diagnostics::Report& report) override {
    if (seen_->flow > 0) look_at_speed(report);
    const auto [cold, hot] = range_to_come();
    if (hot <= cold + 1) return;
    const double mean = air_heat_between(cold, hot) / (hot - cold),
                 error = std::abs(mean / view_.fluid().specific_heat - 1);
    tell(report, {.effect = "specific heat of a gas by its temperature",
                  .number = error,
                  .limit = 0.05,
                  .what = fmt::format("from the coldest to the hottest fluid of the run, air has {:.0f} "
                                      "J/(kg K), a difference of {:.2g} from the constant",
                                      mean, error),
                  .advice = fmt::format("set 'fluid.specific-heat: {:.0f} J/(kg K)'", mean),
                  .share = error});
  }

 private:
  /// Mach number at the hottest gas and narrowest pores, at the outlet pressure.
  void look_at_speed(diagnostics::Report& report) const {
    const Fluid& f = view_.fluid();
    double narrowest = 1;
    for (const auto& run : bed().grid().runs) narrowest = std::min(narrowest, run.layer.porosity);
    const double rt = f.gas_constant * seen_->hottest,
                 speed = seen_->flow / bed().area() * rt / (f.pressure * narrowest);
    const double mach = speed / std::sqrt(f.specific_heat / (f.specific_heat - f.gas_constant) * rt);
    tell(report,
         {.effect = "compressible flow of a gas",
          .number = mach,
          .limit = 0.3,
          .what =
              fmt::format("gas speed between the grains / speed of sound = {:.2g} at the largest flow", mach),
          .advice =
              "the flow is compressible, and neither pressure loss nor films are valid: use less flow, a "
              "wider bed or a higher pressure",
          .share = 0.5 * mach * mach});
  }
};

}  // namespace

Made gas(const TankView& view, const Seen& seen) {
  return view.fluid().is_gas() ? std::make_shared<Gas>(view, seen) : nullptr;
}

}  // namespace couplet::thermocline
