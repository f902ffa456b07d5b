// SPDX-License-Identifier: Apache-2.0
// What a run has seen, for the verdicts on its effects, and what its error is made of.
#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <tuple>

#include "thermocline/judge/effects.hpp"
#include "thermocline/model/tank.hpp"

namespace couplet::thermocline {
namespace {

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

/// Power of a pump of 0.7 over the heat of the largest flow between the coldest and the hottest fluid, and the pressure loss [Pa]:
/// Ergun at the mean of both temperatures, layer by layer.
std::pair<double, double> pumping_share(const TankModel& m, double peak_flow) {
  const Fluid& f = m.setup().fluid;
  const auto [cold, hot] = range_to_come(m);
  const double mean = 0.5 * (cold + hot), area = m.bed().area();
  const double density = f.is_gas() ? f.pressure / (f.gas_constant * mean) : f.density;
  double loss = 0;
  for (const auto& run : m.bed().grid().runs)
    if (run.layer.porosity < 1)
      loss += run.layer.height * ergun(run.layer, f.viscosity(mean), peak_flow / area) / density;
  constexpr double efficiency = 0.7;
  return {loss / (density * efficiency * f.specific_heat * (hot - cold)), loss};
}

/// Of the scene's own pump or fan at the largest flow, the bed all at the mean of both temperatures: its power [W], and the heat
/// that the flow carries between them [W].
std::pair<double, double> driving_power(const TankModel& m, double peak_flow) {
  const Fluid& f = m.setup().fluid;
  const auto [cold, hot] = range_to_come(m);
  const std::vector<double> mean(std::size_t(m.bed().grid().size()), 0.5 * (cold + hot));
  const PressureLoss loss = pressure_loss(m.bed().grid(), f, mean, peak_flow, m.bed().area());
  return {pump_power(loss, f, cold, peak_flow, m.setup().parameters.pump->efficiency),
          peak_flow * f.specific_heat * (hot - cold)};
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

/// What film and grains spread a front by on its way through the bed, over the square of the height: variance 2 (G c/(h a)) (1 - beta)^2 of
/// each metre, beta the fluid's share of the heat capacity (Schumann's model at late times).
double variance_of_grains(const TankModel& m, double peak_flow) {
  const std::span<const double> fluid = m.bed().fluid();
  const double mean = std::accumulate(fluid.begin(), fluid.end(), 0.0) / double(fluid.size());
  const Fluid& f = m.setup().fluid;
  const double flux = peak_flow / m.bed().area();
  double variance = 0, height = 0;
  for (const auto& run : m.bed().grid().runs) {
    height += run.layer.height;
    if (run.layer.porosity >= 1 || run.layer.melting) continue;
    const Filler& filler = run.layer.filler ? *run.layer.filler : m.setup().filler;
    const LayerClosure closure(m.setup().parameters.bed.closures, f, filler, run.layer.porosity,
                               run.layer.diameter);
    const double resistance =
        1 / closure.at(mean, MassFlux(flux)).film + run.layer.diameter / (10 * filler.conductivity);
    const double grains = 1 - run.layer.porosity, of_fluid = run.layer.porosity * f.volumetric(),
                 of_grains = grains * filler.volumetric();
    variance += 2 * run.layer.height * flux * f.specific_heat * resistance * run.layer.diameter /
                (6 * grains) * std::pow(of_grains / (of_fluid + of_grains), 2);
  }
  return variance / (height * height);
}

/// How many standard deviations from the middle of a front that spread like a diffusion a `share` of its step is left beyond.
double deviations(double share) {
  double low = 0, high = 10;
  for (int i = 0; i < 50; ++i) {
    const double z = 0.5 * (low + high);
    (0.5 * std::erfc(z / std::numbers::sqrt2) > share ? low : high) = z;
  }
  return low;
}

}  // namespace

/// A plant ends a charge or a discharge when the outlet differs by the cut-off: while the front's middle is still some deviations inside. That much
/// of the bed stays unused at either end; what the scheme adds to it, the front being spread by film and grains anyway.
double Tank::unused_by_spreading(double finer) const {
  const FlowParameters& flow = accepted_.setup().parameters.flow;
  if (flow.type != FlowParameters::Type::plant || !(peak_flow_ > 0)) return 0;
  const double n = finer * double(accepted_.bed().grid().size()), crossing = crossing_mass(accepted_);
  const double way =
      n * std::min(1., peak_flow_ * (step_.time + step_.dt) / crossing);  // in cells, as the variance
  double variance = 1;
  if (const Advection kind = accepted_.setup().parameters.bed.advection; kind != Advection::tvd)
    variance = way * (1 + (kind == Advection::implicit ? peak_advance_ / crossing * n : 0));
  // A new front in each charge adds variances; tails that stay in the bed from cycle to cycle add widths. The truth of the map tank-plant
  // and of configs/thermocline-rock-air lies between: the mean.
  const double scheme = std::sqrt(variance) / n,
               grains = std::sqrt(variance_of_grains(accepted_, peak_flow_));
  const double added = 0.5 * (scheme + std::hypot(scheme, grains) - grains);
  return 2 * deviations(flow.plant.cut_off / (flow.plant.hot - flow.plant.cold)) * added;
}

diagnostics::ErrorParts Tank::error_parts() const {
  diagnostics::ErrorParts parts = spread_profile();
  if (const double unused = unused_by_spreading(); unused > 0 && !(parts.mesh > unused)) {
    parts.mesh = unused;
    parts.mesh_order = std::log2(
        unused / unused_by_spreading(2));  // upwind: its front widens with the root of the cell size
  }
  parts.dimension = 1;
  return parts;
}

diagnostics::ErrorParts Tank::spread_profile() const {
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
  const double crossing = crossing_mass(accepted_);
  const double way = double(n) * std::min(1., peak_flow_ * (step_.time + step_.dt) / crossing);  // in cells
  diagnostics::ErrorParts parts{.mesh = scheme == Advection::tvd ? one_cell : std::max(1., way) * one_cell};
  if (scheme != Advection::tvd) parts.mesh_order = 1;
  parts.step_order = 1;
  if (scheme == Advection::implicit) parts.step = peak_advance_ / crossing * double(n) * way * one_cell;
  return parts;
}

std::vector<diagnostics::Finding> Tank::effects() const {
  const TankModel& m = accepted_;
  Evidence evidence;
  if (m.setup().fluid.is_gas() && peak_flow_ > 0) evidence.largest_mach = largest_mach(m, peak_flow_);
  if (const auto [cold, hot] = range_to_come(m); m.setup().fluid.is_gas() && hot > cold + 1) {
    evidence.mean_capacity = air_heat_between(cold, hot) / (hot - cold);
    evidence.capacity_error = std::abs(evidence.mean_capacity / m.setup().fluid.specific_heat - 1);
  }
  if (const auto [cold, hot] = range_to_come(m); peak_flow_ > 0 && hot > cold + 1) {
    if (m.setup().parameters.pump)
      std::tie(evidence.driving_power, evidence.carried_heat) = driving_power(m, peak_flow_);
    else
      std::tie(evidence.pumping_share, evidence.pressure_loss) = pumping_share(m, peak_flow_);
  }
  if (m.setup().parameters.bed.advection == Advection::implicit && peak_advance_ > 0) {
    const double part = peak_advance_ / crossing_mass(m);  // v dt / H
    evidence.implicit_spread = std::sqrt(part);
    evidence.implicit_step = 0.9 * 0.05 * 0.05 / part * peak_advance_ / peak_flow_;  // a tenth to spare
  }
  const bool inverted = m.inversion().depth > 0.01 && !m.setup().parameters.bed.mix_inversions;
  if (const auto [cold, hot] = range_to_come(m); inverted && hot > cold + 1) {
    evidence.inversion = m.inversion().depth;
    evidence.inverted_share = evidence.inversion / (hot - cold);
  }
  if (m.bed().shells() == 1 && peak_flow_ > 0) evidence.largest_biot = largest_biot(m, peak_flow_);
  if (m.shell() && !m.stress().yield.empty()) {
    const WallStress& stress = m.stress();
    evidence.share_of_yield = 0;
    for (std::size_t i = 0; i < stress.equivalent.size(); ++i)
      evidence.share_of_yield = std::max(evidence.share_of_yield, stress.equivalent[i] / stress.yield[i]);
  }
  if (bending_.share.shell > 0) {
    evidence.share_as_rings = bending_.share.rings;
    evidence.share_with_bending = bending_.share.shell;
  }
  ElementParameters scene;
  scene.type = ElementParameters::Type::tank;
  scene.tank = m.setup().parameters;
  return effect_findings(scene, evidence);
}

}  // namespace couplet::thermocline
