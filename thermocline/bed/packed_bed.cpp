// SPDX-License-Identifier: Apache-2.0
#include "thermocline/bed/packed_bed.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "common/base/error.hpp"
#include "thermocline/bed/grains.hpp"

namespace couplet::thermocline {

BedConstants::BedConstants(const BedParameters& p, const Medium& its_fluid, const Filler& filler,
                           double diameter)
    : nominal(p.profile_temperature.empty() ? p.initial_temperature
                                            : 0.5 * (std::ranges::min(p.profile_temperature) +
                                                     std::ranges::max(p.profile_temperature))),
      grid(p.layers, p.cells),
      fluid(its_fluid),
      area(0.25 * std::numbers::pi * diameter * diameter),
      shells(p.shells),
      advection(p.advection),
      courant(p.courant),
      conducting_inlet(p.conducting_inlet) {
  for (const BedGrid::Run& run : grid.runs)
    fillers.push_back(run.layer.filler ? make_filler(*run.layer.filler) : filler);
  bool is_nonlinear = false;
  for (std::size_t r = 0; r < fillers.size(); ++r)
    is_nonlinear |= grid.runs[r].layer.melting || fillers[r].depends_on_temperature();
  if (is_nonlinear && advection == Advection::tvd)
    throw Error(
        "bed.advection: tvd supports neither phase-change layers nor properties of the filler that depend on "
        "temperature; use upwind or implicit.");
  const double lightest = std::min(fluid.density, fluid.density_at(fluid.highest));
  for (const BedGrid::Run& run : grid.runs) {
    const Filler& own = fillers[closures.size()];
    closures.emplace_back(p.closures, fluid, own, run.layer.porosity, run.layer.diameter);
    grains.emplace_back(own, run.layer.porosity, run.layer.diameter, shells, nominal);
    if (is_nonlinear) heat.emplace_back();
    if (run.layer.porosity < 1 && (run.layer.melting || own.depends_on_temperature()))
      heat.back().emplace(own, run.layer.melting);
    for (int i = run.first; i < run.first + run.count; ++i) {
      capacity.push_back(run.layer.porosity * fluid.volumetric() * grid.dz[i]);
      heat_capacity += area * (capacity[i] + grains.back().capacity * shells * grid.dz[i]);
      limit = std::min(limit, run.layer.porosity * lightest * grid.dz[i]);
    }
  }
}

PackedBed::PackedBed(const BedParameters& p, const Medium& fluid, const Filler& filler, double diameter)
    : c_(std::make_shared<const BedConstants>(p, fluid, filler, diameter)), capacity_(c_->capacity) {
  const std::size_t n = c_->grid.z.size(), all_shells = n * c_->shells;
  for (auto* v : {&fluid_, &source_, &prepared_.film, &prepared_.conductivity, &prepared_.wall, &work_.extra,
                  &work_.sums, &work_.lower, &work_.diagonal, &work_.upper, &work_.resistance})
    v->assign(n, 0.0);
  work_.face.assign(n + 1, 0.0);
  shell_.assign(all_shells, 0.0);
  if (c_->advection == Advection::tvd) {  // its stages
    work_.fluid1.assign(n, 0.0), work_.fluid2.assign(n, 0.0);
    work_.shell1.assign(all_shells, 0.0), work_.shell2.assign(all_shells, 0.0);
  }
  if (is_nonlinear()) {
    for (auto* v :
         {&work_.nonlinear.capacity, &work_.nonlinear.right, &work_.nonlinear.alpha, &work_.nonlinear.beta})
      v->assign(all_shells, 0.0);
    work_.nonlinear.diagonal.assign(n, 0.0);
  }
  std::vector<double> start(n, p.initial_temperature);
  if (!p.profile_z.empty()) {
    const Curve profile(p.profile_z, p.profile_temperature);
    for (std::size_t i = 0; i < n; ++i) start[i] = profile(c_->grid.z[i]);
  }
  set_temperature(start);
}

void PackedBed::set_temperature(std::span<const double> temperature) {
  std::copy(temperature.begin(), temperature.end(), fluid_.begin());
  for (int j = 0; j < c_->shells; ++j)
    std::copy(temperature.begin(), temperature.end(), shell_.begin() + std::size_t(j) * c_->grid.size());
  follow_density();
}

/// Sets the capacities for the current fluid temperatures.
void PackedBed::follow_density() {
  if (!c_->fluid.real_density) return;
  settled_ = fluid_;
  for (const BedGrid::Run& run : c_->grid.runs)
    for (int i = run.first; i < run.first + run.count; ++i)
      capacity_[i] =
          run.layer.porosity * c_->grid.dz[i] * c_->fluid.specific_heat * c_->fluid.density_at(fluid_[i]);
}

void PackedBed::settle() {
  if (!c_->fluid.real_density) return;
  const DensityLaw& law = *c_->fluid.real;
  for (int i = 0; i < c_->grid.size(); ++i) {
    const double from = settled_[i], heat = law.at(from) * (fluid_[i] - from);
    // Newton's method with a first-order accurate start: two steps converge to round-off.
    for (int k = 0; k < 3; ++k) fluid_[i] -= (law.between(from, fluid_[i]) - heat) / law.at(fluid_[i]);
  }
  follow_density();
}

double PackedBed::largest_step(double mass_flow) const {
  if (mass_flow == 0 || c_->advection == Advection::implicit) return std::numeric_limits<double>::infinity();
  return c_->courant * c_->limit * c_->area / std::abs(mass_flow);
}

void PackedBed::prepare(double dt, double mass_flow) {
  settle();
  prepared_.dt = dt;
  prepared_.mass_flow = mass_flow;
  const MassFlux flux(std::abs(mass_flow) / c_->area);
  for (const BedGrid::Run& run : c_->grid.runs) {
    const std::size_t l = &run - c_->grid.runs.data(), i = run.first;
    c_->closures[l].fill({&fluid_[i], std::size_t(run.count)}, flux, &prepared_.film[i],
                         &prepared_.conductivity[i], &prepared_.wall[i]);
  }
  // SDIRK of order 2 needs gamma = 1 - 1/sqrt(2); see second_order_step.
  build(prepared_.main, c_->advection == Advection::tvd ? dt * (1 - std::numbers::sqrt2 / 2) : dt);
  prepared_.fallback.grains.clear();
}

double PackedBed::inlet_conductance(bool upward) const {
  const int i = upward ? 0 : c_->grid.size() - 1;
  return c_->conducting_inlet ? 2 * prepared_.conductivity[i] / c_->grid.dz[i] : 0;
}

void PackedBed::build(BedOperator& op, double tau) {
  const int n = c_->grid.size();
  const bool same_tau = op.tau == tau && !op.grains.empty();
  op.tau = tau;
  for (auto* v : {&op.rate, &op.share, &op.beta, &op.heat}) v->resize(n);
  if (!same_tau) {
    op.grains.clear();
    for (const Grains& g : c_->grains) op.grains.emplace_back(g, tau);
  }
  for (const BedGrid::Run& run : c_->grid.runs) {
    const std::size_t l = &run - c_->grid.runs.data();
    const double own = op.grains[l].own;
    for (int i = run.first; i < run.first + run.count; ++i) {
      op.rate[i] = capacity_[i] / tau;
      const double g = c_->grains[l].exchange(prepared_.film[i]);
      // Without grains, what stands for them has the fluid's temperature.
      op.share[i] = c_->grains[l].area > 0 ? 1 / (own + g) : 0;
      op.beta[i] = c_->grains[l].area > 0 ? g * op.share[i] : 1;
      op.heat[i] = g * op.share[i] * c_->grid.dz[i];
      work_.diagonal[i] = op.rate[i] + own * op.heat[i];  // g (1 - beta), which does not cancel for large g
    }
  }
  double *a = work_.lower.data(), *b = work_.diagonal.data(), *c = work_.upper.data();
  for (int i = 0; i < n; ++i) work_.resistance[i] = c_->grid.dz[i] / (2 * prepared_.conductivity[i]);
  conduction_rows(n, work_.resistance.data(), a, c);
  for (int i = 0; i < n; ++i) b[i] = b[i] - a[i] - c[i];
  if (prepared_.mass_flow != 0)
    b[prepared_.mass_flow > 0 ? 0 : n - 1] += inlet_conductance(prepared_.mass_flow > 0);
  if (c_->advection == Advection::implicit) {
    const double gc = std::abs(prepared_.mass_flow) / c_->area * c_->fluid.specific_heat;
    for (int i = 0; i < n; ++i) {
      b[i] += gc;
      if (prepared_.mass_flow > 0 && i > 0) a[i] -= gc;
      if (prepared_.mass_flow < 0 && i + 1 < n) c[i] -= gc;
    }
  }
  op.matrix.resize(n);
  op.matrix.factorise(a, b, c);
}

void PackedBed::set_source(std::span<const double> source) {
  source_rate_ = 0;
  for (std::size_t i = 0; i < source_.size(); ++i) source_[i] = source[i] / c_->area;
  if (c_->advection != Advection::tvd) return;  // others do not use it
  for (std::size_t i = 0; i < source_.size(); ++i)
    source_rate_ = std::max(source_rate_, std::abs(source_[i]) / capacity_[i]);
}

double PackedBed::energy(double reference) const {
  const int n = c_->grid.size();
  double sum = 0;
  for (int i = 0; i < n; ++i) {
    double grain = 0;
    for (int j = 0; j < c_->shells; ++j) grain += shell_[std::size_t(j) * n + i] - reference;
    double fluid = capacity_[i] * (fluid_[i] - reference);
    if (c_->fluid.real_density)
      fluid =
          capacity_[i] * (fluid_[i] - settled_[i] +
                          c_->fluid.real->between(reference, settled_[i]) / c_->fluid.real->at(settled_[i]));
    const std::size_t l = c_->grid.layer[i];
    if (is_nonlinear() && c_->heat[l]) {
      double heat = 0;
      for (int j = 0; j < c_->shells; ++j)
        heat += c_->heat[l]->heat(shell_[std::size_t(j) * n + i]) - c_->heat[l]->heat(reference);
      sum += fluid + (1 - c_->grid.runs[l].layer.porosity) / c_->shells * c_->grid.dz[i] * heat;
    } else {
      sum += fluid + c_->grains[l].capacity * c_->grid.dz[i] * grain;
    }
  }
  return c_->area * sum;
}

double PackedBed::heat_between(double cold, double hot) const {
  if (!c_->fluid.real_density && !is_nonlinear()) return c_->heat_capacity * (hot - cold);
  double sum = 0;
  for (const BedGrid::Run& run : c_->grid.runs) {
    const double eps = run.layer.porosity, height = run.layer.height;
    const std::size_t l = &run - c_->grid.runs.data();
    const double mass_degrees =  // integral of the density [kg K/m^3]
        c_->fluid.real_density ? c_->fluid.real->between(cold, hot) : c_->fluid.density * (hot - cold);
    sum += height * eps * c_->fluid.specific_heat * mass_degrees;
    if (is_nonlinear() && c_->heat[l])
      sum += height * (1 - eps) * (c_->heat[l]->heat(hot) - c_->heat[l]->heat(cold));
    else
      sum += height * c_->grains[l].capacity * c_->shells * (hot - cold);
  }
  return c_->area * sum;
}

void PackedBed::filler_temperature(std::vector<double>& mean) const {
  const std::size_t n = c_->grid.size();
  mean.assign(n, 0.0);
  for (int j = 0; j < c_->shells; ++j)
    for (std::size_t i = 0; i < n; ++i) mean[i] += shell_[j * n + i];
  const double share = c_->shells;
  for (double& t : mean) t /= share;
  for (const BedGrid::Run& run : c_->grid.runs)  // without grains, only the fluid
    if (run.layer.porosity >= 1) std::copy_n(fluid_.begin() + run.first, run.count, mean.begin() + run.first);
}

Inversion inversion_of(const PackedBed& bed) {
  const std::span<const double> fluid = bed.fluid();
  const BedGrid& grid = bed.grid();
  Inversion worst;
  double hottest_below = fluid[0];
  for (int i = 1; i < grid.size(); ++i) {
    if (hottest_below - fluid[i] > worst.depth) worst = {hottest_below - fluid[i], grid.z[i]};
    hottest_below = std::max(hottest_below, fluid[i]);
  }
  return worst;
}

void PackedBed::mix_inversions() {
  int inverted = 0;
  for (int i = 0; i + 1 < c_->grid.size(); ++i) inverted += fluid_[i + 1] < fluid_[i];
  if (inverted == 0) return;
  // Pool adjacent violators: from the bottom up, a cell colder than the pool below it joins that pool.
  struct Pool {
    int first;
    double capacity, heat;
    double temperature() const { return heat / capacity; }
  };
  std::vector<Pool> pools;
  for (int i = 0; i < c_->grid.size(); ++i) {
    pools.push_back({i, capacity_[i], capacity_[i] * fluid_[i]});
    while (pools.size() > 1 && pools.back().temperature() < pools[pools.size() - 2].temperature()) {
      const Pool top = pools.back();
      pools.pop_back();
      pools.back().capacity += top.capacity;
      pools.back().heat += top.heat;
    }
  }
  for (std::size_t p = 0; p < pools.size(); ++p) {
    const int end = p + 1 < pools.size() ? pools[p + 1].first : c_->grid.size();
    if (end - pools[p].first > 1)
      std::fill(fluid_.begin() + pools[p].first, fluid_.begin() + end, pools[p].temperature());
  }
}

void PackedBed::resume() {
  follow_density();
  if (prepared_.dt == 0) return;
  // The walls use the coefficients of the last steps, not those of the current temperatures.
  const std::vector<double> wall = prepared_.wall;
  prepare(prepared_.dt, prepared_.mass_flow);
  prepared_.wall = wall;
}

double ergun(const BedLayer& layer, double viscosity, double flux) {
  const double eps = layer.porosity, solid = 1 - eps, d = layer.diameter, eps3 = eps * eps * eps;
  return 150 * viscosity * flux * solid * solid / (eps3 * d * d) + 1.75 * flux * flux * solid / (eps3 * d);
}

PressureLoss pressure_loss(const BedGrid& grid, const Medium& fluid, std::span<const double> temperature,
                           double mass_flow, double area) {
  const double flux = std::abs(mass_flow) / area;
  double sum = 0;  // of dz (...) over the density, times p for a gas
  for (int i = 0; i < grid.size(); ++i) {
    const double t = temperature[i];
    const double drag = grid.dz[i] * ergun(grid.runs[grid.layer[i]].layer, fluid.viscosity(t), flux);
    sum += fluid.is_gas() ? fluid.gas_constant * t * drag : drag / fluid.density_at(t);
  }
  if (!fluid.is_gas()) return {sum, 0};
  return {std::sqrt(fluid.pressure * fluid.pressure + 2 * sum), fluid.pressure};
}

double pump_power(const PressureLoss& loss, const Medium& fluid, double cold_end, double mass_flow,
                  double efficiency) {
  const double m = std::abs(mass_flow), c = fluid.specific_heat;
  if (!fluid.is_gas()) return m * loss.loss() / (fluid.density_at(cold_end) * efficiency);
  const double exponent = fluid.gas_constant / c;
  return m * c * cold_end * std::expm1(exponent * std::log(loss.inlet / loss.outlet)) / efficiency;
}

}  // namespace couplet::thermocline
