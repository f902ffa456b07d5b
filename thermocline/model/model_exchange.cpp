// SPDX-License-Identifier: Apache-2.0
// One exchange step of the tank, element by element.
#include <algorithm>
#include <cmath>
#include <limits>

#include "common/base/error.hpp"
#include "thermocline/model/model.hpp"

namespace couplet::thermocline {

/// Capacity of fluid and filler in a cell of the bed [J/(m^2 K)].
double TankModel::cell_capacity(int i) const {
  const BedGrid& grid = bed_.grid();
  const BedLayer& layer = grid.runs[grid.layer[i]].layer;
  const double solid = bed_.filler(grid.layer[i]).volumetric(bed_.fluid()[i]);
  return (layer.porosity * setup_->fluid.volumetric() + (1 - layer.porosity) * solid) * grid.dz[i];
}

/// Stability of the lowest cell with the flux computed by the ground: half its capacity over the coefficient.
/// A plate below a thin cell stores more heat than that cell.
double TankModel::stable_ground() const {
  return 0.5 * cell_capacity(0) / std::max(1e-30, plate_coefficient());
}

double TankModel::stable_exchange() const {
  // Stability of the end cells with fluxes computed by ullage and ground. Elsewhere the lighter side computes
  // them.
  double step = ground_ ? stable_ground() : std::numeric_limits<double>::infinity();
  if (!ullage_) return step;
  const double strongest = 100;  // of gas and radiation together at any temperature of interest [W/(m^2 K)]
  step = std::min(step, 0.5 * cell_capacity(bed_.grid().size() - 1) / strongest);
  if (!wall_) return step;
  const Steel& steel = *setup_->steel;
  for (int i = setup_->rings->in_bed; i < setup_->rings->size(); ++i)
    step = std::min(
        step, 0.5 * steel.density * steel.specific_heat.y.front() * setup_->rings->thickness[i] / strongest);
  return step;
}

double TankModel::exchange(double t, double h, FlowControl& control, const Weather& weather, TankStep& step) {
  const double tiny = 1e-9 * h;
  const Ambient air = weather.at(t + h / 2);
  if (insulation_) {
    if (side_.until <= t + tiny) step_insulation(t, h, air);
    if (side_.until > t + tiny) h = std::min(h, side_.until - t);
  }
  if (ground_) {
    if (bottom_.until <= t + tiny) step_ground(t, h);
    if (bottom_.until > t + tiny) h = std::min(h, bottom_.until - t);
  }
  if (ullage_) step_ullage(h, air);
  // Heat taken by the shell in the previous step. The wall uses the bed's final temperatures, so that both
  // are at the same time for the contact with the filler; the much heavier bed pays one step later.
  std::vector<double>& source = work_.source;
  for (std::size_t i = 0; i < source.size(); ++i) source[i] = -owed_[i] / h;
  source.back() -= gas_heat_.from_liquid;
  source.front() -= bottom_.in;
  bed_.set_source(source);
  step_bed(t, t + h, control, weather, step);
  if (wall_) {
    step_shell(h);
    update_pressure();
  }
  ledger_.side += side_.out * h;
  ledger_.ground += bottom_.out * h;
  ledger_.turnover += (std::abs(side_.out) + std::abs(bottom_.out)) * h;
  if (wall_ && wall_->filler && !setup_->parameters.external_wall) {
    bed_.filler_temperature(work_.filler);
    wall_->filler->update(wall_->shell.temperature(), work_.filler);
  }
  record_fluid(t + h, step);
  return h;
}

void TankModel::step_insulation(double t, double h, const Ambient& air) {
  const TankParameters& p = setup_->parameters;
  const double step = std::max(h, p.insulation->step);
  const Rings& rings = *setup_->rings;
  const double height = rings.z.back() + rings.dz.back() / 2;
  const double outer = p.diameter + 2 * (rings.thickness.front() + p.insulation->thickness);
  const Film film = side_film_on(*insulation_, outer, height, air);
  const double lost = insulation_->step(step, wall_->shell.temperature(), film, into_blanket_);
  side_ = {t + step, 0, lost / step};
  for (const double q : into_blanket_) side_.in += q;
}

/// Bottom cell to plate: the film of a wall in series with half the cell, which conducts like the stagnant
/// bed (k_0 = film d/2).
double TankModel::plate_coefficient() const {
  const BedGrid& grid = bed_.grid();
  const double d = grid.runs.front().layer.diameter;
  return bed_.wall_coefficient().front() * d / (d + grid.dz.front());
}

void TankModel::step_ground(double t, double h) {
  const double step = std::max(h, std::min(setup_->parameters.ground->step, stable_ground()));
  const Film plate{plate_coefficient(), bed_.bottom()};
  const Film deep{std::numeric_limits<double>::infinity(), deep_temperature_};
  const Column::ColumnHeat heat = ground_->step(step, plate, deep);
  bottom_ = {t + step, heat.inner / step, heat.outer / step};
}

double TankModel::upper_wall() const {
  if (!wall_) return bed_.top();
  const Rings& rings = *setup_->rings;
  double sum = 0, height = 0;
  for (int i = rings.in_bed; i < rings.size(); ++i)
    sum += rings.dz[i] * wall_->shell.temperature()[i], height += rings.dz[i];
  return sum / height;
}

void TankModel::step_ullage(double h, const Ambient& air) {
  const TankParameters& p = setup_->parameters;
  // The roof's inner cell takes the heat explicitly, in steps of half its time constant. If these would be
  // many (thin insulation), the gas uses the roof's implicit response instead.
  const double limit = roof_ ? 0.5 * roof_->inner_capacity() / roof_->inner_conductance() : h;
  constexpr double most_parts = 8;
  const bool light = h > most_parts * limit;
  const int parts = light ? 1 : std::max(1, int(std::ceil(h / limit)));
  gas_heat_ = {};
  for (int k = 0; k < parts; ++k) {
    double roof_cell = roof_ ? roof_->inner_temperature() : 0;
    double conductance = roof_ ? roof_->inner_conductance() * roof_->area() : 0;
    if (light) {
      const Film answer = roof_->inner_response(h, roof_film_on(*roof_, p.diameter, air));
      roof_cell = answer.reference, conductance = answer.coefficient * roof_->area();
    }
    const Ullage::UllageHeat heat =
        ullage_->step(h / parts, bed_.top(), upper_wall(), roof_cell, conductance, air.pressure);
    gas_heat_.from_liquid += heat.from_liquid / parts;
    gas_heat_.from_wall += heat.from_wall / parts;
    gas_heat_.wall_coefficient += heat.wall_coefficient / parts;
    if (!roof_) continue;
    const Film film = roof_film_on(*roof_, p.diameter, air);
    const double lost = roof_->step(h / parts, heat.into_roof, film).outer;
    ledger_.roof += lost;
    ledger_.turnover += std::abs(lost);
  }
  if (!wall_) {  // a wall without a model passes on the heat of the adjacent liquid
    gas_heat_.from_liquid += gas_heat_.from_wall;
    gas_heat_.from_wall = 0;
  }
}

void TankModel::step_shell(double h) {
  const Rings& rings = *setup_->rings;
  work_.from_wall = into_blanket_;
  // Rings above the bed take the mean flux, and more if warmer than the mean.
  double upper = 0;
  for (int i = rings.in_bed; i < rings.size(); ++i) upper += rings.surface(i);
  const double mean = upper_wall();
  for (int i = rings.in_bed; i < rings.size(); ++i)
    work_.from_wall[i] +=
        rings.surface(i) *
        (gas_heat_.from_wall / upper + gas_heat_.wall_coefficient * (wall_->shell.temperature()[i] - mean));
  wall_->shell.step(h, bed_.fluid(), bed_.wall_coefficient(), work_.from_wall, owed_);
  for (double& heat : owed_) heat *= h;
}

namespace {

/// Rejects a flow in a wrong unit, which would fill the memory with steps within a simulated minute.
void refuse_hopeless_flow(double mass_flow, double limit, double span) {
  constexpr double most = 1e6;  // a thousand times what a flow through the finest of grids asks for
  if (span <= most * limit) return;
  throw Error(
      "flow: {:.3g} kg/s crosses a bed cell so fast that {:.3g} s would need {:.2g} sub-steps (at most "
      "{:.0g}). Is the unit of the flow correct? 'bed.advection: implicit' supports any step.",
      mass_flow, span, span / limit, most);
}

}  // namespace

void TankModel::step_bed(double t, double end, FlowControl& control, const Weather& weather, TankStep& step) {
  const double tiny = 1e-9 * (end - t);
  bool prepared = false;
  // With a temperature-dependent density, capacities are updated before any changes by a thousandth.
  const double renewal = bed_.has_real_density() ? 60 : std::numeric_limits<double>::infinity();
  double block = t + renewal;
  while (end - t > tiny) {
    BedStep s;
    s.t = t;
    s.flow = control.decide(t, bed_.top(), bed_.bottom(), weather.at(t));
    const double m = s.flow.mass_flow, limit = bed_.largest_step(m), now = bed_.prepared().mass_flow;
    if (t > block - tiny) prepared = false, block = t + renewal;
    const double until = std::min(block, s.flow.until > t + tiny ? std::min(end, s.flow.until) : end);
    // Updates the closures if the flow has changed by a tenth, and the step if it is too long or would pass
    // the time given by the control. Slightly exceeding the limit is within the scheme's margin.
    const bool other_flow = (m == 0) != (now == 0) || m * now < 0 || std::abs(m - now) > 0.1 * std::abs(now);
    const bool too_long = bed_.prepared().dt > 1.05 * limit || t + bed_.prepared().dt > until + tiny;
    if (!prepared || other_flow || too_long) {
      const double steps_left = std::ceil((until - t) / limit * (1 - 1e-9));
      refuse_hopeless_flow(m, limit, until - t);
      bed_.prepare((until - t) / std::max(1.0, steps_left), m);
      prepared = true;
    }
    s.dt = bed_.prepared().dt;
    const BedHeat heat = bed_.step(m, s.flow.inlet_temperature);
    s.outlet_temperature = heat.outlet;
    ledger_.flow += heat.by_flow;
    ledger_.bed += heat.by_flow + heat.by_source;
    ledger_.turnover += std::abs(heat.by_flow);
    if (setup_->parameters.pump && m != 0) {
      const PressureLoss loss = pressure_loss(bed_.grid(), setup_->fluid, bed_.fluid(), m, bed_.area());
      s.pressure_loss = loss.loss();
      s.pump_power = pump_power(loss, setup_->fluid, bed_.bottom(), m, setup_->parameters.pump->efficiency);
    }
    step.bed.push_back(s);
    t += s.dt;
  }
  if (setup_->parameters.bed.mix_inversions) bed_.mix_inversions();
  bed_.settle();
}

}  // namespace couplet::thermocline
