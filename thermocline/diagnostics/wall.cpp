// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <span>

#include "common/io/checkpoint.hpp"
#include "thermocline/diagnostics/tank_diagnostic.hpp"

namespace couplet::thermocline {
namespace {

/// Wall stress relative to the yield strength, including bending (sampled every two hours), which the rings
/// neglect; also temperatures beyond the metal's range.
class WallStrength final : public TankDiagnostic {
 public:
  using TankDiagnostic::TankDiagnostic;
  void observe(diagnostics::Report& report) override {
    check_temperature(report);
    constexpr double every = 2 * 3600;  // [s]
    const bool is_due = std::floor(view_.time() / every + 1e-9) != std::floor(view_.step.time / every + 1e-9);
    if (view_.parameters().external_wall || !is_due) return;
    const WallStress& stress = view_.model.stress();
    const WallBending bent = wall_bending(rings(), steel(), stress.hoop, view_.model.shell()->temperature());
    const YieldShares now = yield_shares(stress, bent, steel().poissons_ratio);
    share_.rings = std::max(share_.rings, now.rings);
    share_.shell = std::max(share_.shell, now.shell);
  }
  // Compares shares of the strength, so that an almost unloaded wall is not reported.
  void look(diagnostics::Report& report) override {
    const WallStress& stress = view_.model.stress();
    double share = 0;
    for (std::size_t i = 0; i < stress.equivalent.size(); ++i)
      share = std::max(share, stress.equivalent[i] / stress.yield[i]);
    add(report,
        {.effect = "yielding of the wall",
         .id = "yielding",
         .number = share,
         .what = fmt::format("max equivalent stress / yield strength of the wall = {:.2g}", share),
         .advice = "the wall would yield, but its stress and that of the grains are those of an elastic wall",
         .share = std::clamp(share - 1, 0., 1.)});  // of the temperatures it changes nothing
    if (share_.shell > 0)
      add(report,
          {.effect = "bending of the wall",
           .number = share_.shell - share_.rings,
           .what = fmt::format(
               "max equivalent stress / yield strength of the wall: {:.3g} modeled as rings, {:.3g} modeled as a shell",
               share_.rings, share_.shell),
           .advice = "reduce the factors of safety accordingly, or compute the wall as a solid "
                     "('external-wall')",
           .share = std::max(0., 1 - share_.rings / share_.shell)});
  }
  void visit(io::Archive& archive) override { archive.common("bending", share_.rings, share_.shell); }

 private:
  const Rings& rings() const { return *view_.model.setup().rings; }
  const Steel& steel() const { return *view_.model.setup().steel; }

  void check_temperature(diagnostics::Report& report) const {
    const std::vector<double>& wall = view_.model.shell()->temperature();
    const auto [coldest, hottest] = std::ranges::minmax_element(wall);
    const auto z = [&](auto ring) { return rings().z[std::size_t(ring - wall.begin())]; };
    // Allows a tenth of the table's width for walls slightly below the coldest fluid.
    const double low = steel().yield_strength.x.front(), high = steel().yield_strength.x.back();
    const double slack = 0.1 * (high - low);
    const auto outside = *coldest < low - slack ? coldest : hottest;
    if (high > low && (*outside < low - slack || *outside > high + slack))
      add(report, "tank-state", "tables of the wall",
          fmt::format("the wall of {} is at {:.1f} degC at z = {:.3f} m; its properties are known from "
                      "{:.0f} to {:.0f} degC; the end values are used beyond.",
                      steel().name, celsius(*outside), z(outside), celsius(low), celsius(high)));
    if (*hottest > steel().highest)
      add(report, "tank-state", "hot wall",
          fmt::format("the wall of {} is at {:.1f} degC at z = {:.3f} m, above its maximum service "
                      "temperature of {:.1f} degC.",
                      steel().name, celsius(*hottest), z(hottest), celsius(steel().highest)));
  }

  YieldShares share_;  // largest shares of the yield strength
};

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

diagnostics::Made wall_strength(const RunOfTank& run) {
  return run.view.model.shell() ? std::make_shared<WallStrength>(run) : nullptr;
}

diagnostics::Made wall_mechanics(const RunOfTank& run) {
  return run.view.model.shell() ? std::make_shared<WallMechanics>(run) : nullptr;
}

}  // namespace couplet::thermocline
