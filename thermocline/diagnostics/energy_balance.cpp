// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <cmath>

#include "thermocline/diagnostics/tank_diagnostic.hpp"

namespace couplet::thermocline {
namespace {

/// Heat transported and lost, the error of the balance, and the number of steps.
class HeatBalance final : public TankDiagnostic {
 public:
  using TankDiagnostic::TankDiagnostic;
  void conclude(diagnostics::Report& report) override {
    const TankModel& m = view_.model;
    const double turnover = m.ledger().turnover, of_bed = std::abs(m.bed_imbalance()),
                 of_tank = std::abs(m.imbalance(view_.time()));
    if (turnover <= 1e-12 * bed().heat_capacity() * seen_->hottest)
      report.sentences.push_back(fmt::format(
          "energy: no heat moved; energy balance error: bed {:.1e} J, tank {:.1e} J", of_bed, of_tank));
    else
      report.sentences.push_back(fmt::format(
          "energy: {:.4g} MWh moved, {:.4g} MWh lost; energy balance error / heat moved: bed {:.1e}, tank {:.1e}",
          turnover / megawatt_hour, m.ledger().losses() / megawatt_hour, of_bed / turnover,
          of_tank / turnover));
    std::string steps = fmt::format("bed: {} steps of {} cells", bed().steps(), bed().grid().size());
    if (bed().fallbacks() > 0)
      steps +=
          fmt::format("; {} of them {}", bed().fallbacks(),
                      bed().is_nonlinear() ? "ended before the temperatures of the grains converged to 1e-6 K"
                                           : "were first order in time to remain bounded");
    report.sentences.push_back(steps);
  }
};

/// Boundaries of the tank without heat loss because an element is missing.
class NeglectedLosses final : public TankDiagnostic {
 public:
  using TankDiagnostic::TankDiagnostic;
  void conclude(diagnostics::Report& report) override {
    const TankParameters& p = view_.parameters();
    const ElsewhereParameters elsewhere = p.elsewhere.value_or(ElsewhereParameters{});
    const bool has_side = p.insulation || elsewhere.insulation;
    std::string tight;
    for (const auto& [there, name] : {std::pair{has_side, "side (insulation)"},
                                      {p.insulation && p.ullage, "roof (insulation and ullage)"},
                                      {p.ground || elsewhere.ground, "bottom (ground)"}})
      if (!there) tight += fmt::format("{}{}", tight.empty() ? "" : ", ", name);
    if (!tight.empty())
      report.sentences.push_back(fmt::format("no heat loss through neglected elements: {}", tight));
    if (!view_.model.shell() || has_side) return;
    const Rings& rings = *view_.model.setup().rings;
    double area = 0, sum = 0;
    for (int i = 0; i < rings.size(); ++i)
      area += rings.surface(i), sum += rings.surface(i) * view_.model.shell()->temperature()[i];
    const double wall = sum / area, height = rings.z.back() + rings.dz.back() / 2;
    const Film film = side_film(wall, p.diameter, height, view_.weather.at(view_.time()));
    report.sentences.push_back(fmt::format("the bare side, at {:.0f} degC now, would lose {:.3g} MW",
                                           celsius(wall),
                                           1e-6 * area * film.coefficient * (wall - film.reference)));
  }
};

/// Fluid outside its liquid range or tables, and the effect of its constant density.
class FluidRange final : public TankDiagnostic {
 public:
  using TankDiagnostic::TankDiagnostic;
  void observe(diagnostics::Report& report) override {
    const Medium& f = view_.fluid();
    const TankStep& step = view_.happened;
    const double low = step.coldest, high = step.hottest;
    if (high > f.highest)
      add(report, "tank-state", "hot fluid",
          fmt::format(
              "the {} is at {:.1f} degC at z = {:.3g} m, above its limit of {:.1f} degC, where it boils "
              "or decomposes. Lower the inlet temperature, or use another fluid.",
              f.name, celsius(high), step.hottest_z, celsius(f.highest)));
    if (low < f.lowest)
      add(report, "tank-state", "cold fluid",
          fmt::format(
              "the {} is at {:.1f} degC at z = {:.3g} m, below its limit of {:.1f} degC, where it freezes. "
              "Raise the inlet temperature, insulate the tank, or use another fluid.",
              f.name, celsius(low), step.coldest_z, celsius(f.lowest)));
    const double slack = 0.1 * (f.known_to - f.known_from);
    const bool cold = low < f.known_from - slack;
    if (cold || high > f.known_to + slack)
      add(report, "tank-state", "tables of the fluid",
          fmt::format(
              "the {} is at {:.1f} degC at z = {:.3g} m; its conductivity and viscosity are given from "
              "{:.1f} to {:.1f} degC (fluid.temperature); the end values are used beyond.",
              f.name, celsius(cold ? low : high), cold ? step.coldest_z : step.hottest_z,
              celsius(f.known_from), celsius(f.known_to)));
  }
  void conclude(diagnostics::Report& report) override {
    const Medium& f = view_.fluid();
    const double cold = seen_->coldest, hot = seen_->hottest;
    if (f.real && !f.real_density && hot > cold)
      report.sentences.push_back(fmt::format(
          "density: constant for {} at {:.1f} kg/m^3; from {:.0f} to {:.0f} degC it falls from {:.0f} to "
          "{:.0f} (fluid.real-density)",
          f.name, f.density, celsius(cold), celsius(hot), f.real->at(cold), f.real->at(hot)));
  }
};

}  // namespace

diagnostics::Made energy_balance(const RunOfTank& run) { return std::make_shared<HeatBalance>(run); }

diagnostics::Made surroundings(const RunOfTank& run) { return std::make_shared<NeglectedLosses>(run); }

diagnostics::Made fluid_range(const RunOfTank& run) { return std::make_shared<FluidRange>(run); }

}  // namespace couplet::thermocline
