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
  const auto [coldest, hottest] = std::minmax_element(bed_.fluid().begin(), bed_.fluid().end());
  // The start counts: a strong flow may leave nothing of it after a step.
  coldest_ = *coldest;
  hottest_ = *hottest;
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

template <class Self, class F>
void TankModel::visit(Self& self, F&& f) {
  f("bed", self.bed_);
  if (self.shell_) f("shell", self.shell_->temperature()), f("owed-to-shell", self.owed_);
  if (self.mechanics_) f("filler-mechanics", *self.mechanics_);
  if (self.contact_) f("contact", *self.contact_);
  if (self.insulation_) f("insulation", self.insulation_->temperature());
  if (self.insulation_ || (self.setup_->parameters.elsewhere && self.shell_))
    f("into-blanket", self.into_blanket_);
  if (self.roof_) f("roof", self.roof_->temperature());
  if (self.ground_) f("ground", self.ground_->temperature());
  if (self.ullage_) f("ullage", *self.ullage_, self.from_liquid_, self.wall_to_ullage_);
  PackedBed::visit_prepared(self.bed_, f);
  auto& side = self.side_;
  auto& soil = self.soil_;
  auto& l = self.ledger_;
  auto& worst = self.inversion_;
  f("books", side.until, side.in, side.out, soil.until, soil.in, soil.out, l.flow, l.side, l.roof, l.ground,
    l.bed, l.turnover, self.reference_, self.start_energy_, self.start_bed_, worst.depth, worst.z, worst.time,
    self.coldest_, self.hottest_);
}

std::vector<std::pair<std::string, std::vector<double>>> TankModel::state() const {
  std::vector<std::pair<std::string, std::vector<double>>> all;
  visit(*this, [&](const char* name, const auto&... parts) { all.emplace_back(name, numbers_of(parts...)); });
  return all;
}

void TankModel::restore(const std::function<std::vector<double>(const std::string&)>& read) {
  visit(*this, [&](const char* name, auto&&... parts) { set_numbers(read(name), name, parts...); });
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

void TankModel::advance(double t, double dt, FlowControl& control, const Weather& weather,
                        std::vector<BedStep>& steps, Speed& speed) {
  const double own = setup_->parameters.exchange_step, end = t + dt;
  const double longest = own > 0 ? std::min(own, dt) : dt;
  const double tiny = 1e-9 * dt;
  while (end - t > tiny) {
    const double rest = end - t, wanted = std::min(longest, stable_exchange());
    const double h =
        exchange(t, rest / std::ceil(rest / wanted * (1 - 1e-9)), control, weather, steps, speed);
    t = end - (t + h) <= tiny ? end : t + h;
  }
  update_stress();
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

void TankModel::watch(double t) {
  if (const auto now = inversion_of(bed_); now.depth > inversion_.depth) inversion_ = {now.depth, now.z, t};
  const auto fluid = bed_.fluid();
  const auto [low, high] = std::minmax_element(fluid.begin(), fluid.end());
  coldest_ = std::min(coldest_, *low);
  hottest_ = std::max(hottest_, *high);
  const auto place = [&](auto it) { return bed_.grid().z[it - fluid.begin()]; };
  const Fluid& f = setup_->fluid;
  if (!std::isfinite(*high) || !std::isfinite(*low) || *low < 0)
    throw SolveFailure("A temperature of the bed is not finite or below absolute zero.");
  if (*high > f.highest && !std::exchange(warned_hot_, true))
    warnings_.push_back(
        fmt::format("t = {:.6g} s: the {} is at {:.1f} degC at z = {:.3f} m, above its limit of {:.1f} "
                    "degC, where it boils or decomposes. Lower the inlet temperature, or use another "
                    "fluid.",
                    t, f.name, *high - zero_celsius, place(high), f.highest - zero_celsius));
  if (*low < f.lowest && !std::exchange(warned_cold_, true))
    warnings_.push_back(
        fmt::format("t = {:.6g} s: the {} is at {:.1f} degC at z = {:.3f} m, below its limit of {:.1f} "
                    "degC, where it freezes. Raise the inlet temperature, insulate the tank, or use "
                    "another fluid.",
                    t, f.name, *low - zero_celsius, place(low), f.lowest - zero_celsius));
  const double slack = 0.1 * (f.known_to - f.known_from);
  const auto outside = *low < f.known_from - slack ? low : high;
  if ((*outside < f.known_from - slack || *outside > f.known_to + slack) &&
      !std::exchange(warned_fluid_, true))
    warnings_.push_back(fmt::format(
        "t = {:.6g} s: the {} is at {:.1f} degC at z = {:.3f} m; its conductivity and viscosity are "
        "given from {:.1f} to {:.1f} degC (fluid.temperature); the end values are used beyond.",
        t, f.name, celsius(*outside), place(outside), celsius(f.known_from), celsius(f.known_to)));
  if (shell_) watch_wall(t);
}

void TankModel::watch_wall(double t) {
  const auto wall = shell_->temperature();
  const auto [coldest, hottest] = std::minmax_element(wall.begin(), wall.end());
  const Steel& steel = *setup_->steel;
  // A tenth of the table's width is left to the walls that cool a little below the coldest fluid.
  const double low = steel.yield_strength.x.front(), high = steel.yield_strength.x.back();
  const double slack = 0.1 * (high - low);
  const auto outside = *coldest < low - slack ? coldest : hottest;
  if (high > low && (*outside < low - slack || *outside > high + slack) &&
      !std::exchange(warned_range_, true))
    warnings_.push_back(
        fmt::format("t = {:.6g} s: the wall of {} is at {:.1f} degC at z = {:.3f} m; its properties are "
                    "known from {:.0f} to {:.0f} degC; the end values are used beyond.",
                    t, steel.name, celsius(*outside), setup_->rings->z[outside - wall.begin()], celsius(low),
                    celsius(high)));
  if (*hottest > setup_->steel->highest && !std::exchange(warned_metal_, true))
    warnings_.push_back(
        fmt::format("t = {:.6g} s: the wall of {} is at {:.1f} degC at z = {:.3f} m, above its maximum "
                    "service temperature of {:.1f} degC.",
                    t, setup_->steel->name, *hottest - zero_celsius, setup_->rings->z[hottest - wall.begin()],
                    setup_->steel->highest - zero_celsius));
}

}  // namespace couplet::thermocline
