// SPDX-License-Identifier: Apache-2.0
#include "thermocline/bed/packed_bed.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "common/base/error.hpp"
#include "thermocline/bed/grains.hpp"

namespace couplet::thermocline {

PackedBed::PackedBed(const BedParameters& p, const Fluid& fluid, const Filler& filler, double diameter)
    : grid_(p.layers, p.cells),
      liquid_(fluid),
      area_(0.25 * std::numbers::pi * diameter * diameter),
      shells_(p.shells),
      advection_(p.advection),
      courant_(p.courant),
      conducting_inlet_(p.conducting_inlet) {
  const int n = grid_.size();
  limit_ = std::numeric_limits<double>::infinity();
  capacity_.resize(n);
  std::vector<LayerClosure> closures;
  const bool melts =
      std::any_of(p.layers.begin(), p.layers.end(), [](const BedLayer& l) { return l.melting; });
  for (const BedGrid::Run& run : grid_.runs) {
    const Filler& own = run.layer.filler ? *run.layer.filler : filler;
    closures.emplace_back(p.closures, fluid, own, run.layer.porosity, run.layer.diameter);
    grains_.emplace_back(own, run.layer.porosity, run.layer.diameter, shells_);
    if (melts) melting_.emplace_back();
    if (run.layer.melting) melting_.back().emplace(own, *run.layer.melting);
    for (int i = run.first; i < run.first + run.count; ++i) {
      capacity_[i] = run.layer.porosity * fluid.volumetric() * grid_.dz[i];
      heat_capacity_ += area_ * (capacity_[i] + grains_.back().capacity * shells_ * grid_.dz[i]);
      const double lightest = std::min(fluid.density, fluid.density_at(fluid.highest));
      limit_ = std::min(limit_, run.layer.porosity * lightest * grid_.dz[i]);
    }
  }
  closures_ = std::make_shared<const std::vector<LayerClosure>>(std::move(closures));
  for (auto* v : {&fluid_, &extra_, &source_, &film_, &conductivity_, &wall_, &sums_, &lower_, &diagonal_,
                  &upper_, &exchange_})
    v->assign(n, 0.0);
  face_.assign(n + 1, 0.0);
  shell_.assign(std::size_t(n) * shells_, 0.0);
  if (advection_ == Advection::tvd) {  // its stages
    fluid1_.assign(n, 0.0), fluid2_.assign(n, 0.0);
    shell1_.assign(shell_.size(), 0.0), shell2_.assign(shell_.size(), 0.0);
  }
  if (melts) {
    for (auto* v : {&melt_.capacity, &melt_.right, &melt_.alpha, &melt_.beta}) v->assign(shell_.size(), 0.0);
    melt_.diagonal.assign(n, 0.0);
    main_.own_part.assign(n, 0.0);
    if (advection_ == Advection::tvd)
      throw Error("bed.advection: tvd does not support phase-change layers; use upwind or implicit.");
  }
  std::vector<double> start(n, p.initial_temperature);
  if (!p.profile_z.empty()) {
    const Table profile(p.profile_z, p.profile_temperature);
    for (int i = 0; i < n; ++i) start[i] = profile(grid_.z[i]);
  }
  set_temperature(start);
}

void PackedBed::set_temperature(std::span<const double> temperature) {
  std::copy(temperature.begin(), temperature.end(), fluid_.begin());
  for (int j = 0; j < shells_; ++j)
    std::copy(temperature.begin(), temperature.end(), shell_.begin() + std::size_t(j) * grid_.size());
  sums_of_ = 0;
  follow_density();
}

/// Capacities of the fluid's temperatures as they are.
void PackedBed::follow_density() {
  if (!liquid_.real_density) return;
  settled_ = fluid_;
  for (const BedGrid::Run& run : grid_.runs)
    for (int i = run.first; i < run.first + run.count; ++i)
      capacity_[i] = run.layer.porosity * grid_.dz[i] * liquid_.specific_heat * liquid_.density_at(fluid_[i]);
}

void PackedBed::settle() {
  if (!liquid_.real_density) return;
  const DensityLaw& law = *liquid_.real;
  for (int i = 0; i < grid_.size(); ++i) {
    const double from = settled_[i], heat = law.at(from) * (fluid_[i] - from);
    // Newton's method from a start that is right to first order: two steps reach rounding.
    for (int k = 0; k < 3; ++k) fluid_[i] -= (law.between(from, fluid_[i]) - heat) / law.at(fluid_[i]);
  }
  follow_density();
}

double PackedBed::largest_step(double mass_flow) const {
  if (mass_flow == 0 || advection_ == Advection::implicit) return std::numeric_limits<double>::infinity();
  return courant_ * limit_ * area_ / std::abs(mass_flow);
}

void PackedBed::prepare(double dt, double mass_flow) {
  settle();
  prepared_.dt = dt;
  prepared_.mass_flow = mass_flow;
  const MassFlux flux(std::abs(mass_flow) / area_);
  for (const BedGrid::Run& run : grid_.runs) {
    const std::size_t l = &run - grid_.runs.data(), i = run.first;
    (*closures_)[l].fill({&fluid_[i], std::size_t(run.count)}, flux, &film_[i], &conductivity_[i], &wall_[i]);
  }
  // SDIRK of order 2 needs gamma = 1 - 1/sqrt(2); see second_order_step.
  build(main_, advection_ == Advection::tvd ? dt * (1 - std::numbers::sqrt2 / 2) : dt);
  fallback_is_built_ = false;
}

double PackedBed::inlet_conductance(bool upward) const {
  const int i = upward ? 0 : grid_.size() - 1;
  return conducting_inlet_ ? 2 * conductivity_[i] / grid_.dz[i] : 0;
}

void PackedBed::build(Operator& op, double tau) {
  const int n = grid_.size();
  const bool same_tau = op.tau == tau && !op.grains.empty();
  op.tau = tau;
  sums_of_ = 0;
  for (auto* v : {&op.rate, &op.share, &op.beta, &op.heat}) v->resize(n);
  if (!same_tau) {
    op.grains.clear();
    for (const Grains& g : grains_) op.grains.emplace_back(g, tau);
  }
  for (const BedGrid::Run& run : grid_.runs) {
    const std::size_t l = &run - grid_.runs.data();
    const int i = run.first;
    if (grains_[l].area > 0)
      exchange_rows({tau, op.grains[l].own, grains_[l].area, grains_[l].surface},
                    {&capacity_[i], &film_[i], &grid_.dz[i], std::size_t(run.count)},
                    {&op.rate[i], &op.share[i], &op.beta[i], &op.heat[i], &diagonal_[i]});
    else  // no grains: what stands for them has the fluid's temperature
      for (int k = i; k < i + run.count; ++k)
        diagonal_[k] = op.rate[k] = capacity_[k] / tau, op.share[k] = op.heat[k] = 0, op.beta[k] = 1;
  }
  if (!op.own_part.empty())
    for (int i = 0; i < n; ++i) op.own_part[i] = diagonal_[i] - op.rate[i];
  conduction_rows(n, conductivity_.data(), grid_.dz.data(), lower_.data(), diagonal_.data(), upper_.data());
  double *a = lower_.data(), *b = diagonal_.data(), *c = upper_.data();
  if (prepared_.mass_flow != 0)
    b[prepared_.mass_flow > 0 ? 0 : n - 1] += inlet_conductance(prepared_.mass_flow > 0);
  if (advection_ == Advection::implicit) {
    const double gc = std::abs(prepared_.mass_flow) / area_ * liquid_.specific_heat;
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
  for (std::size_t i = 0; i < source_.size(); ++i) source_[i] = source[i] / area_;
  if (advection_ != Advection::tvd) return;  // which alone asks for it
  for (std::size_t i = 0; i < source_.size(); ++i)
    source_rate_ = std::max(source_rate_, std::abs(source_[i]) / capacity_[i]);
}

double PackedBed::energy(double reference) const {
  const int n = grid_.size();
  double sum = 0;
  for (int i = 0; i < n; ++i) {
    double grain = 0;
    for (int j = 0; j < shells_; ++j) grain += shell_[std::size_t(j) * n + i] - reference;
    double fluid = capacity_[i] * (fluid_[i] - reference);
    if (liquid_.real_density)
      fluid = capacity_[i] * (fluid_[i] - settled_[i] +
                              liquid_.real->between(reference, settled_[i]) / liquid_.real->at(settled_[i]));
    const std::size_t l = grid_.layer[i];
    if (!melting_.empty() && melting_[l]) {
      double heat = 0;
      for (int j = 0; j < shells_; ++j)
        heat += melting_[l]->heat(shell_[std::size_t(j) * n + i]) - melting_[l]->heat(reference);
      sum += fluid + (1 - grid_.runs[l].layer.porosity) / shells_ * grid_.dz[i] * heat;
    } else {
      sum += fluid + grains_[l].capacity * grid_.dz[i] * grain;
    }
  }
  return area_ * sum;
}

double PackedBed::heat_between(double cold, double hot) const {
  if (!liquid_.real_density && melting_.empty()) return heat_capacity_ * (hot - cold);
  double sum = 0;
  for (const BedGrid::Run& run : grid_.runs) {
    const double eps = run.layer.porosity, height = run.layer.height;
    const std::size_t l = &run - grid_.runs.data();
    const double mass_degrees =  // integral of the density [kg K/m^3]
        liquid_.real_density ? liquid_.real->between(cold, hot) : liquid_.density * (hot - cold);
    sum += height * eps * liquid_.specific_heat * mass_degrees;
    if (!melting_.empty() && melting_[l])
      sum += height * (1 - eps) * (melting_[l]->heat(hot) - melting_[l]->heat(cold));
    else
      sum += height * grains_[l].capacity * shells_ * (hot - cold);
  }
  return area_ * sum;
}

void PackedBed::filler_temperature(std::vector<double>& mean) const {
  const std::size_t n = grid_.size();
  mean.assign(n, 0.0);
  for (int j = 0; j < shells_; ++j)
    for (std::size_t i = 0; i < n; ++i) mean[i] += shell_[j * n + i];
  const double share = shells_;
  for (double& t : mean) t /= share;
  for (const BedGrid::Run& run : grid_.runs)  // fluid alone: there are no grains
    if (run.layer.porosity >= 1) std::copy_n(fluid_.begin() + run.first, run.count, mean.begin() + run.first);
}

double PackedBed::reynolds(int cell, double mass_flow) const {
  return (*closures_)[grid_.layer[cell]].reynolds(fluid_[cell], std::abs(mass_flow) / area_);
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
  for (int i = 0; i + 1 < grid_.size(); ++i) inverted += fluid_[i + 1] < fluid_[i];
  if (inverted == 0) return;
  // Pool adjacent violators: from the bottom up, a cell colder than the pool below it joins that pool.
  struct Pool {
    int first;
    double capacity, heat;
    double temperature() const { return heat / capacity; }
  };
  std::vector<Pool> pools;
  for (int i = 0; i < grid_.size(); ++i) {
    pools.push_back({i, capacity_[i], capacity_[i] * fluid_[i]});
    while (pools.size() > 1 && pools.back().temperature() < pools[pools.size() - 2].temperature()) {
      const Pool top = pools.back();
      pools.pop_back();
      pools.back().capacity += top.capacity;
      pools.back().heat += top.heat;
    }
  }
  for (std::size_t p = 0; p < pools.size(); ++p) {
    const int end = p + 1 < pools.size() ? pools[p + 1].first : grid_.size();
    if (end - pools[p].first > 1)
      std::fill(fluid_.begin() + pools[p].first, fluid_.begin() + end, pools[p].temperature());
  }
}

std::vector<double> PackedBed::state() const {
  std::vector<double> all(fluid_);
  all.insert(all.end(), shell_.begin(), shell_.end());
  return all;
}

void PackedBed::restore(std::span<const double> state) {
  if (state.size() != fluid_.size() + shell_.size())
    throw Error("bed: the checkpoint has {} temperatures, the bed {}; run with the same cells and shells.",
                state.size(), fluid_.size() + shell_.size());
  std::copy_n(state.begin(), fluid_.size(), fluid_.begin());
  std::copy(state.begin() + fluid_.size(), state.end(), shell_.begin());
  sums_of_ = 0;
  follow_density();
}

double ergun(const BedLayer& layer, double viscosity, double flux) {
  const double eps = layer.porosity, solid = 1 - eps, d = layer.diameter, eps3 = eps * eps * eps;
  return 150 * viscosity * flux * solid * solid / (eps3 * d * d) + 1.75 * flux * flux * solid / (eps3 * d);
}

PressureLoss pressure_loss(const BedGrid& grid, const Fluid& fluid, std::span<const double> temperature,
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

double pump_power(const PressureLoss& loss, const Fluid& fluid, double cold_end, double mass_flow,
                  double efficiency) {
  const double m = std::abs(mass_flow), c = fluid.specific_heat;
  if (!fluid.is_gas()) return m * loss.loss() / (fluid.density_at(cold_end) * efficiency);
  const double exponent = fluid.gas_constant / c;
  return m * c * cold_end * std::expm1(exponent * std::log(loss.inlet / loss.outlet)) / efficiency;
}

}  // namespace couplet::thermocline
