// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include "thermocline/diagnostics/tank_diagnostic.hpp"

namespace couplet::thermocline {
namespace {

/// Fluid outside its liquid range or tables, and the effect of its constant density.
class FluidRange final : public TankDiagnostic {
 public:
  using TankDiagnostic::TankDiagnostic;
  void observe(diagnostics::Report& report) override {
    const Fluid& f = view_.fluid();
    const TankStep& step = view_.happened;
    const double low = step.coldest, high = step.hottest;
    if (high > f.highest)
      tell(report, "tank-state", "hot fluid",
           fmt::format(
               "the {} is at {:.1f} degC at z = {:.3g} m, above its limit of {:.1f} degC, where it boils "
               "or decomposes. Lower the inlet temperature, or use another fluid.",
               f.name, celsius(high), step.hottest_z, celsius(f.highest)));
    if (low < f.lowest)
      tell(report, "tank-state", "cold fluid",
           fmt::format(
               "the {} is at {:.1f} degC at z = {:.3g} m, below its limit of {:.1f} degC, where it freezes. "
               "Raise the inlet temperature, insulate the tank, or use another fluid.",
               f.name, celsius(low), step.coldest_z, celsius(f.lowest)));
    const double slack = 0.1 * (f.known_to - f.known_from);
    const bool cold = low < f.known_from - slack;
    if (cold || high > f.known_to + slack)
      tell(report, "tank-state", "tables of the fluid",
           fmt::format(
               "the {} is at {:.1f} degC at z = {:.3g} m; its conductivity and viscosity are given from "
               "{:.1f} to {:.1f} degC (fluid.temperature); the end values are used beyond.",
               f.name, celsius(cold ? low : high), cold ? step.coldest_z : step.hottest_z,
               celsius(f.known_from), celsius(f.known_to)));
  }
  void conclude(diagnostics::Report& report) override {
    const Fluid& f = view_.fluid();
    const double cold = seen_->coldest, hot = seen_->hottest;
    if (f.real && !f.real_density && hot > cold)
      report.sentences.push_back(fmt::format(
          "density: constant for {} at {:.1f} kg/m^3; from {:.0f} to {:.0f} degC it falls from {:.0f} to "
          "{:.0f} (fluid.real-density)",
          f.name, f.density, celsius(cold), celsius(hot), f.real->at(cold), f.real->at(hot)));
  }
};

}  // namespace

Made fluid_range(const TankView& view, const Seen& seen) { return std::make_shared<FluidRange>(view, seen); }

}  // namespace couplet::thermocline
