// SPDX-License-Identifier: Apache-2.0
#include "thermocline/model/model.hpp"

#include <algorithm>
#include <cmath>

#include "common/base/error.hpp"

namespace couplet::thermocline {

std::vector<ColumnLayer> ground_layers(const GroundParameters& p) {
  std::vector<ColumnLayer> layers;
  double depth = 0;
  for (const GroundLayer& l : p.layers) {
    // Cells grow with depth, where temperatures change slowly.
    const double cell = std::max(p.cell, 0.1 * depth);
    layers.push_back(
        {foundation_material(l.material), l.thickness, std::max(1, int(std::ceil(l.thickness / cell)))});
    depth += l.thickness;
  }
  return layers;
}

TankSetup::TankSetup(const TankParameters& p)
    : parameters(p),
      fluid(make_fluid(p.fluid)),
      filler(make_filler(p.filler)),
      grid(p.bed.layers, p.bed.cells) {
  if (!p.shell) return;
  steel = make_steel(p.shell->material);
  rings.emplace(*p.shell, grid, p.diameter, p.ullage ? p.ullage->height : 0);
  pressure = inner_pressure(*rings, grid, fluid, filler, p.ullage ? p.ullage->gauge_pressure : 0);
}

TankModel::TankModel(std::shared_ptr<const TankSetup> setup, const Weather& weather)
    : setup_(std::move(setup)),
      bed_(setup_->parameters.bed, setup_->fluid, setup_->filler, setup_->parameters.diameter) {
  const TankParameters& p = setup_->parameters;
  const Ambient air = weather.at(0);
  const int n = bed_.grid().size();
  bed_.prepare(1, 0);
  ledger_.reference = bed_.bottom();
  owed_.assign(n, 0.0), work_.source.assign(n, 0.0);
  if (p.shell) {
    const int rings = setup_->rings->size();
    std::vector<double> wall(rings, bed_.top());
    std::copy(bed_.fluid().begin(), bed_.fluid().end(), wall.begin());
    wall_.emplace(Wall{Shell(*setup_->rings, *setup_->steel)});
    wall_->shell.set_temperature(wall);
    into_blanket_.assign(rings, 0.0);
    if (p.insulation) {
      const double radius = p.diameter / 2 + setup_->rings->thickness.front();
      insulation_.emplace(*p.insulation, setup_->rings->dz, radius);
      insulation_->set_steady(wall, air.temperature);
    }
    update_pressure();
    bed_.filler_temperature(work_.filler);
    if (p.mechanics)
      wall_->filler.emplace(*setup_->rings, *setup_->steel, setup_->filler, pressure(), wall, work_.filler,
                            p.external_wall.has_value());
    update_stress();
  }
  if (p.ullage) {
    ullage_.emplace(p.ullage->gauge_pressure, p.diameter, p.ullage->height);
    ullage_->set_gas(bed_.top());
    if (p.insulation) {
      roof_.emplace(std::vector<ColumnLayer>{{make_insulator(p.insulation->material), p.insulation->thickness,
                                              p.insulation->cells}},
                    bed_.area());
      roof_->set_steady(bed_.top(), air.temperature);
    }
  }
  if (p.ground) {
    deep_temperature_ = weather.mean_temperature();
    ground_.emplace(ground_layers(*p.ground), bed_.area());
    ground_->set_steady(bed_.bottom(), deep_temperature_);
  }
  ledger_.start = energy(0);
  ledger_.start_of_bed = bed_.energy(ledger_.reference);
}

void TankModel::resume() {
  bed_.resume();
  if (!wall_) return;
  update_pressure();
  if (wall_->filler) wall_->filler->finish();
  update_stress();
}

double TankModel::energy(double t) const {
  const double reference = ledger_.reference;
  double sum = bed_.energy(reference);
  for (const double owed : owed_) sum -= owed;
  // A held flux is already included in insulation or ground until its step ends.
  const auto ahead = [&](const Held& h) { return h.until > t ? (h.in - h.out) * (h.until - t) : 0; };
  if (wall_) sum += wall_->shell.energy(reference);
  if (insulation_) sum += insulation_->energy(reference) - ahead(side_);
  if (roof_) sum += roof_->energy(reference);
  if (ullage_) sum += ullage_->energy(reference);
  if (ground_) sum += ground_->energy(reference) - ahead(bottom_);
  return sum;
}

TankStep TankModel::advance(double t, double dt, FlowControl& control, const Weather& weather) {
  TankStep step;
  const double own = setup_->parameters.exchange_step, end = t + dt;
  const double longest = own > 0 ? std::min(own, dt) : dt;
  const double tiny = 1e-9 * dt;
  while (end - t > tiny) {
    const double rest = end - t, wanted = std::min(longest, stable_exchange());
    const double h = exchange(t, rest / std::ceil(rest / wanted * (1 - 1e-9)), control, weather, step);
    t = end - (t + h) <= tiny ? end : t + h;
  }
  update_stress();
  return step;
}

void TankModel::update_contact(std::span<const double> radial) {
  bed_.filler_temperature(work_.filler);
  wall_->filler->update(wall_->shell.temperature(), work_.filler, radial);
  update_stress();
}

void TankModel::hold_side(std::span<const double> from_rings) {
  if (from_rings.empty()) return;
  side_ = {};
  for (std::size_t i = 0; i < into_blanket_.size(); ++i) side_.in += into_blanket_[i] = from_rings[i];
  side_.out = side_.in;
}

void TankModel::update_pressure() {
  if (!bed_.has_real_density()) return;
  const TankParameters& p = setup_->parameters;
  wall_->pressure = inner_pressure(*setup_->rings, bed_.grid(), setup_->fluid, setup_->filler,
                                   p.ullage ? p.ullage->gauge_pressure : 0, bed_.fluid());
  if (wall_->filler) wall_->filler->load(*wall_->pressure);
}

void TankModel::update_stress() {
  if (!wall_) return;
  std::vector<double> active;
  if (!wall_->filler) active = active_hoop(*setup_->rings, setup_->filler, pressure());
  wall_stress(*setup_->rings, *setup_->steel, pressure(), wall_->filler ? wall_->filler->hoop() : active,
              wall_->shell.temperature(), wall_->stress);
}

void TankModel::record_fluid(double t, TankStep& step) const {
  if (const Inversion now = inversion_of(bed_); now.depth > step.inversion.depth)
    step.inversion = {now.depth, now.z, t};
  const std::span<const double> fluid = bed_.fluid();
  const auto [low, high] = std::ranges::minmax_element(fluid);
  const auto height = [&](auto cell) { return bed_.grid().z[std::size_t(cell - fluid.begin())]; };
  if (*low < step.coldest) step.coldest = *low, step.coldest_z = height(low);
  if (*high > step.hottest) step.hottest = *high, step.hottest_z = height(high);
  for (std::size_t r = 0; r < bed_.grid().runs.size(); ++r) {
    const Filler& filler = bed_.filler(r);  // counts as use of its tables
    for (const double t : {*low, *high}) (void)filler.specific_heat(t), (void)filler.conductivity(t);
  }
  if (!std::isfinite(*high) || !std::isfinite(*low) || *low < 0)
    throw SolveFailure("A temperature of the bed is not finite or below absolute zero.");
}

}  // namespace couplet::thermocline
