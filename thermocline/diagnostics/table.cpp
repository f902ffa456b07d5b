// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "common/io/checkpoint.hpp"
#include "thermocline/diagnostics/tank_diagnostic.hpp"

namespace couplet::thermocline {

namespace {

/// Records the extreme values that others read.
class ExtremesOfRun final : public TankDiagnostic {
 public:
  using TankDiagnostic::TankDiagnostic;
  void observe(diagnostics::Report&) override {
    for (const BedStep& s : view_.happened.bed) {
      seen_->flow = std::max(seen_->flow, std::abs(s.flow.mass_flow));
      seen_->advance = std::max(seen_->advance, std::abs(s.flow.mass_flow) * s.dt);
      seen_->moved += std::abs(s.flow.mass_flow) * s.dt;
    }
    seen_->coldest = std::min(seen_->coldest, view_.happened.coldest);
    seen_->hottest = std::max(seen_->hottest, view_.happened.hottest);
  }
  void visit(io::Archive& archive) override { archive.common("extremes", *seen_); }
};

}  // namespace

diagnostics::Made extremes(const RunOfTank& run) { return std::make_shared<ExtremesOfRun>(run); }

namespace {

using diagnostics::When;
using TankRow = diagnostics::TableRow<RunOfTank>;

// The others read the extremes.
constexpr std::array table{TankRow{"extremes", When::always, extremes},
                           TankRow{"energy-balance", When::always, energy_balance},
                           TankRow{"fluid-range", When::always, fluid_range},
                           TankRow{"grains", When::always, grains},
                           TankRow{"still-bed", When::always, still_bed},
                           TankRow{"inversions", When::always, inversions},
                           TankRow{"pumping", When::always, pumping},
                           TankRow{"gas", When::always, gas},
                           TankRow{"wall-strength", When::always, wall_strength},
                           TankRow{"wall-mechanics", When::always, wall_mechanics},
                           TankRow{"surroundings", When::always, surroundings},
                           TankRow{"unused-input", When::always, unused_input},
                           TankRow{"front-error", When::with_errors, front_error}};

}  // namespace

void add_diagnostics(const TankView& view, diagnostics::Diagnostics& all) {
  const auto [low, high] = std::ranges::minmax(view.model.bed().fluid());
  const auto seen = std::make_shared<Extremes>(Extremes{.coldest = low, .hottest = high});
  all.add(std::span<const TankRow>(table), {view, seen});
}

std::pair<double, double> TankDiagnostic::range_to_come() const {
  double cold = seen_->coldest, hot = seen_->hottest;
  const auto see = [&](double t) { cold = std::min(cold, t), hot = std::max(hot, t); };
  const FlowParameters& flow = view_.parameters().flow;
  if (flow.type == FlowParameters::Type::plant) see(flow.plant.cold), see(flow.plant.hot);
  if (flow.type == FlowParameters::Type::schedule)
    for (const ScheduleRow& row : flow.rows)
      if (row.mass_flow != 0) see(row.inlet_temperature);
  return {cold, hot};
}

double TankDiagnostic::variance_of_grains() const {
  const std::span<const double> fluid = bed().fluid();
  const double mean = std::accumulate(fluid.begin(), fluid.end(), 0.0) / double(fluid.size());
  const Medium& f = view_.fluid();
  const double flux = seen_->flow / bed().area();
  double variance = 0;
  for (std::size_t r = 0; r < bed().grid().runs.size(); ++r) {
    const BedLayer& layer = bed().grid().runs[r].layer;
    if (layer.porosity >= 1 || layer.melting) continue;
    const Filler& filler = bed().filler(r);
    const double resistance = 1 / bed().closure(r).at(mean, MassFlux(flux)).film +
                              layer.diameter / (10 * value_of(filler.conductivity, mean));
    const double solid = 1 - layer.porosity, of_grains = solid * filler.volumetric(mean);
    const double share = of_grains / (layer.porosity * f.volumetric() + of_grains);
    variance +=
        2 * layer.height * flux * f.specific_heat * resistance * layer.diameter / (6 * solid) * share * share;
  }
  return variance / (bed().grid().height * bed().grid().height);
}

void TankDiagnostic::add(diagnostics::Report& report, const diagnostics::EffectFinding& effect) {
  if (auto finding = diagnostics::finding_of(effect)) report.findings.push_back(std::move(*finding));
}

void TankDiagnostic::add(diagnostics::Report& report, const char* id, std::string subject,
                         const std::string& sentence) const {
  report.findings.push_back(
      {.id = id, .sentence = fmt::format("{}: {}", view_.name, sentence), .subject = std::move(subject)});
}

}  // namespace couplet::thermocline
