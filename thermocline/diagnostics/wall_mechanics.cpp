// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <span>

#include "thermocline/diagnostics/tank_diagnostic.hpp"

namespace couplet::thermocline {
namespace {

/// Grains displaced by the wall, or the stress neglected without them.
class WallMechanics final : public TankDiagnostic {
 public:
  using TankDiagnostic::TankDiagnostic;
  void conclude(diagnostics::Report& report) override {
    const TankModel& m = view_.model;
    const FillerMechanics* filler = m.mechanics();
    if (!filler) {
      const auto [low, high] = std::ranges::minmax(m.shell()->temperature());
      const Steel& steel = *m.setup().steel;
      const double strain =
          steel.thermal_strain(high) - steel.thermal_strain(low) - m.setup().filler.expansion * (high - low);
      report.sentences.push_back(fmt::format(
          "filler mechanics neglected: cooling a ring from {:.0f} to {:.0f} degC against a rigid filler would "
          "add {:.0f} MPa of hoop stress",
          celsius(high), celsius(low), 1e-6 * steel.youngs_modulus(low) * std::max(0.0, strain)));
      return;
    }
    const std::span<const double> slip = filler->slip();
    const std::size_t i = std::max_element(slip.begin(), slip.end()) - slip.begin();
    report.sentences.push_back(fmt::format(
        "filler: {} of {} rings have reached the passive limit; max cumulative displacement of the grains by "
        "the wall {:.2g} mm, at z = {:.2f} m",
        std::ranges::count_if(slip, [](double s) { return s > 0; }), slip.size(),
        500 * slip[i] * m.setup().rings->diameter, m.setup().rings->z[i]));
  }
};

}  // namespace

Made wall_mechanics(const TankView& view, const Seen& seen) {
  return view.model.shell() ? std::make_shared<WallMechanics>(view, seen) : nullptr;
}

}  // namespace couplet::thermocline
