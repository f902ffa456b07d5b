// SPDX-License-Identifier: Apache-2.0
// What a run says at its end: its books, the effects it left out and how large they are, its speed.
#include <algorithm>
#include <cmath>
#include <numeric>

#include "common/log/doubt.hpp"
#include "common/log/log.hpp"
#include "common/parallel/collective.hpp"
#include "thermocline/effect_cards.hpp"
#include "thermocline/questions.hpp"
#include "thermocline/tank.hpp"

namespace couplet::thermocline {
namespace {

using Lines = std::vector<std::string>;

void energy(const TankModel& m, double t, Lines& lines) {
  const double turnover = m.ledger().turnover,
               hair = 1e-12 * m.bed().heat_capacity() * m.fluid_range().second;
  if (turnover <= hair) {
    lines.push_back(fmt::format(
        "energy: no heat was moved; the books of the bed are off by {:.1e} J, those of the tank by {:.1e} J",
        std::abs(m.bed_imbalance()), std::abs(m.imbalance(t))));
    return;
  }
  lines.push_back(fmt::format(
      "energy: {:.4g} MWh moved, {:.4g} MWh lost; the books of the bed are off by {:.1e}, those of "
      "the tank by {:.1e} of what was moved",
      turnover / 3.6e9, m.losses() / 3.6e9, std::abs(m.bed_imbalance()) / turnover,
      std::abs(m.imbalance(t)) / turnover));
}

/// A parabola stands for the profile in each grain: late by d^2/(60 a) for what changes slowly, wrong for
/// what changes faster than that.
void lumped_grains(const TankModel& m, Lines& lines) {
  const Filler& filler = m.setup().filler;
  double largest = 0;
  for (const auto& run : m.bed().grid().runs)
    if (run.layer.porosity < 1) largest = std::max(largest, run.layer.diameter);
  if (largest == 0) return;
  lines.push_back(fmt::format(
      "grains: shells: 1 takes one temperature a grain and a parabola inside it (linear driving force); "
      "grains of {:.3g} mm follow changes slower than {:.3g} s, five shells are within 2 % of all",
      1e3 * largest, largest * largest * filler.volumetric() / (60 * filler.conductivity)));
}

/// Of the layers of grains, at the largest flow and the bed's mean temperature.
double largest_biot(const TankModel& m, double peak_flow) {
  const std::span<const double> fluid = m.bed().fluid();
  double mean = 0, largest = 0;
  for (const double t : fluid) mean += t / double(fluid.size());
  for (const auto& run : m.bed().grid().runs) {
    if (run.layer.porosity >= 1 || run.layer.melting) continue;
    const Filler& filler = run.layer.filler ? *run.layer.filler : m.setup().filler;
    const LayerClosure closure(m.setup().parameters.bed.closures, m.setup().fluid, filler, run.layer.porosity,
                               run.layer.diameter);
    const double film = closure.at(mean, MassFlux(peak_flow / m.bed().area())).film;
    largest = std::max(largest, film * run.layer.diameter / (2 * filler.conductivity));
  }
  return largest;
}

/// Of an ideal gas where it is hottest and the pores are narrowest, at the pressure at which it leaves.
double largest_mach(const TankModel& m, double peak_flow) {
  const Fluid& gas = m.setup().fluid;
  double narrowest = 1;
  for (const auto& run : m.bed().grid().runs) narrowest = std::min(narrowest, run.layer.porosity);
  const double hottest = m.fluid_range().second, r = gas.gas_constant;
  const double speed = peak_flow / m.bed().area() * r * hottest / (gas.pressure * narrowest);
  return speed / std::sqrt(gas.specific_heat / (gas.specific_heat - r) * r * hottest);
}

/// Heat capacity of the whole bed over that of a kilogram of fluid [kg]: what must flow in for a front to cross it.
double crossing_mass(const TankModel& m) {
  const Fluid& f = m.setup().fluid;
  double capacity = 0;
  for (const auto& run : m.bed().grid().runs) {
    const Filler& filler = run.layer.filler ? *run.layer.filler : m.setup().filler;
    double height = 0;
    for (int i = run.first; i < run.first + run.count; ++i) height += m.bed().grid().dz[i];
    capacity += height * m.bed().area() *
                (run.layer.porosity * f.volumetric() + (1 - run.layer.porosity) * filler.volumetric());
  }
  return capacity / f.specific_heat;
}

/// Coldest and hottest fluid of the run, and what the flow will bring: a verdict on the first hours, in which the bed is still
/// cold, would be one on another range than the run's.
std::pair<double, double> range_to_come(const TankModel& m) {
  auto [cold, hot] = m.fluid_range();
  const auto see = [&](double t) { cold = std::min(cold, t), hot = std::max(hot, t); };
  const FlowParameters& flow = m.setup().parameters.flow;
  if (flow.type == FlowParameters::Type::plant) see(flow.plant.cold), see(flow.plant.hot);
  if (flow.type == FlowParameters::Type::schedule)
    for (const ScheduleRow& row : flow.rows)
      if (row.mass_flow != 0) see(row.inlet_temperature);
  return {cold, hot};
}

void fluid(const TankModel& m, double peak_flow, Lines& lines) {
  if (m.inversion().depth > 0.01)
    lines.push_back(fmt::format(
        "buoyancy: at t = {:.6g} s fluid at z = {:.3f} m was {:.2f} K colder than the fluid below it; {}",
        m.inversion().time, m.inversion().z, m.inversion().depth,
        m.setup().parameters.bed.mix_inversions ? "such fluid is mixed"
                                                : "mixing it (bed.mix-inversions) was left out"));
  const Fluid& f = m.setup().fluid;
  const auto [cold, hot] = m.fluid_range();
  if (f.real && !f.real_density && hot > cold)
    lines.push_back(fmt::format(
        "density: that of the {} was kept at {:.1f} kg/m^3; from {:.0f} to {:.0f} degC it falls from {:.0f} "
        "to {:.0f} (fluid.real-density)",
        f.name, f.density, celsius(cold), celsius(hot), f.real->at(cold), f.real->at(hot)));
  if (m.bed().shells() == 1) lumped_grains(m, lines);
  if (peak_flow == 0) return;
  // Numerical diffusion G c dz (1 - Co)/2 of the bed's whole capacity, over the way H at the front's speed.
  const BedParameters& bed = m.setup().parameters.bed;
  const double spread =
      std::sqrt((bed.advection == Advection::upwind ? 1 - bed.courant : 1) / m.bed().grid().size());
  if (bed.advection != Advection::tvd && spread > 0.05)
    lines.push_back(fmt::format(
        "cells: upwind differences of {} cells spread a front that crosses the bed over {:.2g} of its height (standard deviation){}",
        m.bed().grid().size(), spread,
        bed.advection == Advection::upwind ? "; bed.advection: tvd does not" : ""));
  if (!m.setup().parameters.pump) {
    const PressureLoss loss = pressure_loss(m.bed().grid(), f, m.bed().fluid(), peak_flow, m.bed().area());
    lines.push_back(fmt::format(
        "pressure: the bed's {:.3g} kPa at the largest flow, {:.3g} kW of a pump, were left out (pump)",
        1e-3 * loss.loss(), 1e-3 * pump_power(loss, f, m.bed().bottom(), peak_flow, 0.7)));
  }
  std::string layers;
  for (const auto& run : m.bed().grid().runs)
    layers += fmt::format("{}{:.3g}", layers.empty() ? "" : ", ",
                          m.bed().reynolds(run.first + run.count / 2, peak_flow));
  lines.push_back(
      fmt::format("closures: Re of the layers at the largest flow {} from the bottom up; the film's "
                  "correlation was fitted to Re from 15 to 8500",
                  layers));
}

void surroundings(const TankModel& m, const Ambient& air, Lines& lines) {
  const TankParameters& p = m.setup().parameters;
  std::string tight;
  const ElsewhereParameters elsewhere = p.elsewhere.value_or(ElsewhereParameters{});
  for (const auto& [there, name] : {std::pair{p.insulation || elsewhere.insulation, "side (insulation)"},
                                    {p.insulation && p.ullage, "roof (insulation and ullage)"},
                                    {p.ground || elsewhere.ground, "bottom (ground)"}})
    if (!there) tight += fmt::format("{}{}", tight.empty() ? "" : ", ", name);
  if (!tight.empty()) lines.push_back(fmt::format("no heat leaves through what was left out: {}", tight));
  if (!m.shell() || p.insulation || elsewhere.insulation) return;
  const auto& rings = *m.setup().rings;
  double area = 0, sum = 0;
  for (int i = 0; i < rings.size(); ++i)
    area += rings.surface(i), sum += rings.surface(i) * m.shell()->temperature()[i];
  const double wall = sum / area, height = rings.z.back() + rings.dz.back() / 2;
  const Film film = side_film({}, wall, p.diameter, height, air);
  lines.push_back(fmt::format("the bare side, at {:.0f} degC now, would lose {:.3g} MW", celsius(wall),
                              1e-6 * area * film.coefficient * (wall - film.reference)));
}

void wall(const TankModel& m, const BendingSeen& bending, Lines& lines) {
  const auto& rings = m.setup().rings;
  const double diameter = m.setup().parameters.diameter;
  if (m.shell() && !m.mechanics() && !m.contact()) {
    const auto wall = m.shell()->temperature();
    const auto [low, high] = std::minmax_element(wall.begin(), wall.end());
    const Steel& steel = *m.setup().steel;
    const double strain = steel.thermal_strain(*high) - steel.thermal_strain(*low) -
                          m.setup().filler.expansion * (*high - *low);
    lines.push_back(fmt::format(
        "filler mechanics were left out: cooling a ring from {:.0f} to {:.0f} degC against a filler "
        "that does not yield would add {:.0f} MPa of hoop stress",
        celsius(*high), celsius(*low), 1e-6 * steel.youngs_modulus(*low) * std::max(0.0, strain)));
  }
  if (m.shell() && !m.contact()) {
    // beta^4 = 3 (1 - nu^2)/(a^2 e^2): edge effects of a cylinder fade as exp(-beta z).
    const double nu = m.setup().steel->poissons_ratio;
    const double e = *std::max_element(rings->thickness.begin(), rings->thickness.end());
    std::string line =
        fmt::format("bending of the wall was left out: it rounds off what changes within {:.2f} m",
                    std::sqrt(diameter / 2 * e) / std::pow(3 * (1 - nu * nu), 0.25));
    if (bending.rings > 0)
      line += fmt::format(
          "; the largest hoop stress of {:.0f} MPa becomes {:.0f} at z = {:.2f} m, and the wall bends with "
          "up to {:.0f} "
          "MPa along z, at z = {:.2f} m and t = {:.6g} s, {} (external-wall computes it)",
          1e-6 * bending.rings, 1e-6 * bending.shell, bending.shell_z, 1e-6 * bending.axial, bending.axial_z,
          bending.axial_time,
          bending.axial > 0.5 * bending.rings ? "which matters" : "small beside the hoop stress");
    lines.push_back(line);
  }
  if (!m.mechanics() && !m.contact()) return;
  const auto slip = m.mechanics() ? m.mechanics()->slip() : m.contact()->slip();
  const std::size_t i = std::max_element(slip.begin(), slip.end()) - slip.begin();
  lines.push_back(
      fmt::format("filler: {} of {} rings have reached the passive limit; over the run "
                  "the wall has pushed the grains in by {:.2g} mm in all where that was most, z = {:.2f} m",
                  std::count_if(slip.begin(), slip.end(), [](double s) { return s > 0; }), slip.size(),
                  500 * slip[i] * diameter, rings->z[i]));
}

void speed(const Speed& speed, int cells, Lines& lines) {
  double total = 0;
  for (const double s : speed.seconds) total += s;
  if (speed.cell_steps == 0) return;
  std::string shares;
  for (std::size_t i = 0; i < element_names.size(); ++i)
    if (speed.seconds[i] > 0)
      shares += fmt::format("{}{} {:.2f} ns ({:.0f} %)", shares.empty() ? "" : ", ", element_names[i],
                            1e9 * speed.seconds[i] / speed.cell_steps, 100 * speed.seconds[i] / total);
  lines.push_back(fmt::format("speed: {:.2f} ns per cell-step of the bed in {} steps of {} cells: {}",
                              1e9 * total / speed.cell_steps, speed.bed_steps, cells, shares));
}

}  // namespace

ErrorParts Tank::error_parts() const {
  std::vector<double> t;
  accepted_.bed().filler_temperature(t);
  const std::size_t n = t.size();
  if (n < 3 || !(peak_flow_ > 0)) return {};
  const double mean = std::accumulate(t.begin(), t.end(), 0.0) / double(n);
  double bends = 0, size = 0;  // second differences, dz^2 times the second derivative
  for (std::size_t i = 0; i < n; ++i) {
    size += std::abs(t[i] - mean);
    if (i > 0 && i + 1 < n) bends += std::abs(t[i - 1] - 2 * t[i] + t[i + 1]);
  }
  if (!(size > 1e-9 * std::abs(mean) * double(n))) return {};  // one temperature: nothing to be spread
  const double one_cell = 0.5 * bends / size;                  // s = dz
  const Advection scheme = accepted_.setup().parameters.bed.advection;
  ErrorParts parts{.mesh = scheme == Advection::tvd ? one_cell : double(n) * one_cell};
  if (scheme == Advection::implicit)
    parts.step = peak_advance_ / crossing_mass(accepted_) * double(n) * double(n) * one_cell;
  return parts;
}

std::vector<EffectVerdict> Tank::audit() const {
  const TankModel& m = accepted_;
  Evidence evidence;
  if (m.setup().fluid.is_gas() && peak_flow_ > 0) evidence.largest_mach = largest_mach(m, peak_flow_);
  if (const auto [cold, hot] = range_to_come(m); m.setup().fluid.is_gas() && hot > cold + 1) {
    evidence.mean_capacity = air_heat_between(cold, hot) / (hot - cold);
    evidence.capacity_error = std::abs(evidence.mean_capacity / m.setup().fluid.specific_heat - 1);
  }
  if (m.setup().parameters.bed.advection == Advection::implicit && peak_advance_ > 0) {
    const double part = peak_advance_ / crossing_mass(m);  // v dt / H
    evidence.implicit_spread = std::sqrt(part);
    evidence.implicit_step = 0.05 * 0.05 / part * peak_advance_ / peak_flow_;
  }
  if (m.bed().shells() == 1 && peak_flow_ > 0) evidence.largest_biot = largest_biot(m, peak_flow_);
  if (m.shell() && !m.stress().yield.empty()) {
    const WallStress& stress = m.stress();
    evidence.share_of_yield = 0;
    for (std::size_t i = 0; i < stress.equivalent.size(); ++i)
      evidence.share_of_yield = std::max(evidence.share_of_yield, stress.equivalent[i] / stress.yield[i]);
  }
  ElementParameters scene;
  scene.type = ElementParameters::Type::tank;
  scene.tank = m.setup().parameters;
  return couplet::audit(effect_cards(), scene, evidence);
}

std::vector<std::string> Tank::finish() {
  for (const auto& observer : observers_) {
    observer->finish();
    for (const std::string& doubt : observer->doubts())
      log::doubt(comm_rank(comm_), fmt::format("{}: {}", name_, doubt));
  }
  Lines lines;
  const TankModel& m = accepted_;
  for (const std::string& sentence : control_->doubts())
    log::doubt(comm_rank(comm_), fmt::format("{}: {}", name_, sentence));
  for (const std::string& sentence : never_melted(m))
    log::doubt(comm_rank(comm_), fmt::format("{}: {}", name_, sentence));
  const double t = step_.time + step_.dt;
  energy(m, t, lines);
  fluid(m, peak_flow_, lines);
  surroundings(m, weather_->at(t), lines);
  if (m.bed().fallbacks() > 0)
    lines.push_back(fmt::format("bed: {} of {} steps {}", m.bed().fallbacks(), speed_.bed_steps,
                                m.bed().melts()
                                    ? "ended before the temperatures of what melts agreed to 1e-6 K"
                                    : "were taken at first order in time to stay within bounds"));
  wall(m, bending_, lines);
  thermocline::speed(speed_, m.bed().grid().size(), lines);
  return lines;
}

}  // namespace couplet::thermocline
