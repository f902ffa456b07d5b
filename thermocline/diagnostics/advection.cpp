// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <cmath>

#include "thermocline/diagnostics/tank_diagnostic.hpp"

namespace couplet::thermocline {
namespace {

/// Numerical spreading of a front that crosses the bed. First order in time acts like a diffusion v^2 dt/2 at
/// front speed v, over the height H sqrt(v dt H). Four hundred steps per crossing give 0.05 (within 0.1 % of
/// Schumann's gas bed, docs/validation/tank-tables.md). Cells add G c dz (1 - Co)/2 of the bed.
class FirstOrderAdvection final : public TankDiagnostic {
 public:
  using TankDiagnostic::TankDiagnostic;
  void look(diagnostics::Report& report) override {
    if (view_.parameters().bed.advection != Advection::implicit || !(seen_->advance > 0)) return;
    const double part = seen_->advance / crossing_mass();  // v dt / H
    constexpr double limit = 0.05;
    tell(report,
         {.effect = "implicit advection",
          .number = std::sqrt(part),
          .limit = limit,
          .what = fmt::format("implicit advection with this step smears a front that crosses the bed over "
                              "{:.2g} of its height (standard deviation)",
                              std::sqrt(part)),
          // With a margin of a tenth.
          .advice = fmt::format("use 'simulation.time-step: {:.2g} s'",
                                0.9 * limit * limit / part * seen_->advance / seen_->flow),
          .left_out = false});
  }
  void conclude(diagnostics::Report& report) override {
    const BedParameters& p = view_.parameters().bed;
    const int cells = bed().grid().size();
    const double spread = std::sqrt((p.advection == Advection::upwind ? 1 - p.courant : 1) / cells);
    if (seen_->flow > 0 && p.advection != Advection::tvd && spread > 0.05)
      report.sentences.push_back(fmt::format(
          "cells: upwind differences of {} cells smear a front that crosses the bed over {:.2g} of its height "
          "(standard deviation){}",
          cells, spread, p.advection == Advection::upwind ? "; bed.advection: tvd does not" : ""));
  }
};

}  // namespace

Made advection(const TankView& view, const Seen& seen) {
  return std::make_shared<FirstOrderAdvection>(view, seen);
}

}  // namespace couplet::thermocline
