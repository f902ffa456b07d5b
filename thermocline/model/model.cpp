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
    // Cells grow with the depth: what is deep changes slowly.
    const double cell = std::max(p.cell, 0.1 * depth);
    layers.push_back(
        {foundation_material(l.material), l.thickness, std::max(1, int(std::ceil(l.thickness / cell)))});
    depth += l.thickness;
  }
  return layers;
}

TankSetup::TankSetup(const TankParameters& p)
    : parameters(p), fluid(make_fluid(p.fluid)), filler(p.filler), grid(p.bed.layers, p.bed.cells) {
  if (!p.shell) return;
  steel = make_steel(p.shell->material);
  rings.emplace(*p.shell, grid, p.diameter, p.ullage ? p.ullage->height : 0);
  pressure = inner_pressure(*rings, grid, fluid, filler, p.ullage ? p.ullage->gas.gauge_pressure : 0);
}

TankModel::TankModel(std::shared_ptr<const TankSetup> setup, const Weather& weather)
    : setup_(std::move(setup)),
      bed_(setup_->parameters.bed, setup_->fluid, setup_->filler, setup_->parameters.diameter) {
  const TankParameters& p = setup_->parameters;
  const Ambient air = weather.at(0);
  const int n = bed_.grid().size();
  bed_.prepare(1, 0);
  reference_ = bed_.bottom();
  owed_.assign(n, 0.0), source_.assign(n, 0.0);
  if (p.shell) {
    const int rings = setup_->rings->size();
    std::vector<double> wall(rings, bed_.top());
    std::copy(bed_.fluid().begin(), bed_.fluid().end(), wall.begin());
    shell_.emplace(*setup_->rings, *setup_->steel);
    shell_->set_temperature(wall);
    into_blanket_.assign(rings, 0.0), from_wall_.assign(rings, 0.0);
    if (p.insulation) {
      const double radius = p.diameter / 2 + setup_->rings->thickness.front();
      insulation_.emplace(*p.insulation, setup_->rings->dz, radius);
      insulation_->set_steady(wall, air.temperature);
    }
    update_pressure();
    hoop_ = active_hoop(*setup_->rings, setup_->filler, pressure());
    bed_.filler_temperature(filler_);
    if (p.external_wall)
      contact_.emplace(*setup_->rings, *setup_->steel, setup_->filler, pressure(), wall, filler_);
    else if (p.mechanics)
      mechanics_.emplace(*setup_->rings, *setup_->steel, setup_->filler, pressure(), wall, filler_);
    update_stress();
  }
  if (p.ullage) {
    ullage_.emplace(p.ullage->gas, p.diameter, p.ullage->height);
    ullage_->set_gas(bed_.top());
    if (p.insulation) {
      roof_.emplace(std::vector<ColumnLayer>{{make_insulator(p.insulation->material), p.insulation->thickness,
                                              p.insulation->cells}},
                    bed_.area());
      roof_->set_steady(bed_.top(), air.temperature);
    }
  }
  if (p.ground) {
    deep_temperature_ = p.ground->deep_temperature.value_or(weather.mean_temperature());
    ground_.emplace(ground_layers(*p.ground), bed_.area());
    ground_->set_steady(bed_.bottom(), deep_temperature_);
  }
  start_energy_ = energy(0);
  start_bed_ = bed_.energy(reference_);
}

void TankModel::resume() {
  bed_.resume();
  if (shell_) update_pressure();
  if (contact_) contact_->finish();
  update_stress();
}

double TankModel::energy(double t) const {
  double sum = bed_.energy(reference_);
  for (const double owed : owed_) sum -= owed;
  // A held flux is already in the temperatures of the insulation or the ground until its step ends.
  const auto ahead = [&](const Held& h) { return h.until > t ? (h.in - h.out) * (h.until - t) : 0; };
  if (shell_) sum += shell_->energy(reference_);
  if (insulation_) sum += insulation_->energy(reference_) - ahead(side_);
  if (roof_) sum += roof_->energy(reference_);
  if (ullage_) sum += ullage_->energy(reference_);
  if (ground_) sum += ground_->energy(reference_) - ahead(soil_);
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
  bed_.filler_temperature(filler_);
  contact_->update(radial, shell_->temperature(), filler_);
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
  pressure_ = inner_pressure(*setup_->rings, bed_.grid(), setup_->fluid, setup_->filler,
                             p.ullage ? p.ullage->gas.gauge_pressure : 0, bed_.fluid());
  if (mechanics_) mechanics_->load(*pressure_);
  if (contact_) contact_->load(*pressure_);
  if (!mechanics_ && !contact_) hoop_ = active_hoop(*setup_->rings, setup_->filler, *pressure_);
}

void TankModel::update_stress() {
  if (!shell_) return;
  const std::span<const double> hoop = mechanics_ ? mechanics_->hoop()
                                       : contact_ ? contact_->hoop()
                                                  : std::span<const double>(hoop_);
  wall_stress(*setup_->rings, *setup_->steel, pressure(), setup_->parameters.shell->roof_pressure, hoop,
              shell_->temperature(), stress_);
}

void TankModel::record_fluid(double t, TankStep& step) const {
  if (const Inversion now = inversion_of(bed_); now.depth > step.inversion.depth)
    step.inversion = {now.depth, now.z, t};
  const auto [low, high] = std::minmax_element(bed_.fluid().begin(), bed_.fluid().end());
  step.coldest = std::min(step.coldest, *low);
  step.hottest = std::max(step.hottest, *high);
  if (!std::isfinite(*high) || !std::isfinite(*low) || *low < 0)
    throw SolveFailure("A temperature of the bed is not finite or below absolute zero.");
}

}  // namespace couplet::thermocline
