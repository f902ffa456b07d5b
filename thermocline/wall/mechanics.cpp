// SPDX-License-Identifier: Apache-2.0
#include "thermocline/wall/mechanics.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "common/base/error.hpp"

namespace couplet::thermocline {

double rankine_active(const Filler& filler) {
  const double s = std::sin(filler.friction_angle);
  return (1 - s) / (1 + s);
}

InnerPressure inner_pressure(const Rings& rings, const BedGrid& bed, const Fluid& fluid, const Filler& filler,
                             double ullage_gauge, std::span<const double> temperature) {
  InnerPressure p;
  p.fluid.assign(rings.size(), ullage_gauge);
  p.vertical.assign(rings.size(), 0.0);
  double below = 0;  // vertical pressure at the lower face of the cell above
  double column = 0;
  for (int i = rings.in_bed - 1; i >= 0; --i) {
    const double density = temperature.empty() ? fluid.density : fluid.density_at(temperature[i]);
    column += density * gravity * bed.dz[i];
    p.fluid[i] += column - density * gravity * bed.dz[i] / 2;
    const double porosity = bed.runs[bed.layer[i]].layer.porosity;
    const auto& grains = bed.runs[bed.layer[i]].layer.filler;
    const double solid = grains ? grains->density : filler.density;
    const double own = (1 - porosity) * (solid - density) * gravity * bed.dz[i];
    p.vertical[i] = std::max(0.0, below + own / 2);  // mean of its faces; grains that float do not press
    below += own;
  }
  return p;
}

FillerMechanics::FillerMechanics(const Rings& rings, const Steel& steel, const Filler& filler,
                                 const InnerPressure& p, std::span<const double> wall,
                                 std::span<const double> grains)
    : rings_(&rings),
      steel_(&steel),
      expansion_(filler.expansion),
      active_ratio_(rankine_active(filler)),
      grains_(grains.begin(), grains.end()) {
  const int n = rings.size();
  for (int i = 0; i < n; ++i) per_pressure_.push_back(rings.diameter / (2 * rings.thickness[i]));
  for (auto* v : {&fluid_, &active_, &passive_}) v->resize(n);
  load(p);
  strain_.assign(rings.in_bed, -1e3);  // far inside: the first update finds every ring active
  hoop_.resize(n), lateral_.assign(n, 0.0), contact_.assign(rings.in_bed, Contact::active);
  slip_.assign(rings.in_bed, 0.0);
  update(wall, grains);
}

void FillerMechanics::load(const InnerPressure& p) {
  for (std::size_t i = 0; i < fluid_.size(); ++i) {
    fluid_[i] = p.fluid[i];
    active_[i] = p.fluid[i] + active_ratio_ * p.vertical[i];
    passive_[i] = p.fluid[i] + p.vertical[i] / active_ratio_;
  }
}

void FillerMechanics::update(std::span<const double> wall, std::span<const double> grains) {
  for (int i = 0; i < rings_->in_bed; ++i) {
    const double e = steel_->youngs_modulus(wall[i]), free = steel_->thermal_strain(wall[i]);
    const double lowest = active_[i] * per_pressure_[i], highest = passive_[i] * per_pressure_[i];
    // (5.18) as D exp(alpha dT): printed as D (1 + alpha dT), which a cycle would leave smaller.
    strain_[i] += expansion_ * (grains[i] - grains_[i]);
    grains_[i] = grains[i];
    const double held = e * (strain_[i] - free);
    if (held <= lowest) {
      contact_[i] = Contact::active;
      hoop_[i] = lowest;
      strain_[i] = lowest / e + free;  // the grains slump after the wall
    } else if (held >= highest) {
      contact_[i] = Contact::passive;
      slip_[i] += (held - highest) / e;
      hoop_[i] = highest;
      strain_[i] = highest / e + free;  // the wall pushes them in
    } else {
      contact_[i] = Contact::rigid;
      hoop_[i] = held;
    }
    lateral_[i] = hoop_[i] / per_pressure_[i] - fluid_[i];
  }
  for (int i = rings_->in_bed; i < rings_->size(); ++i) hoop_[i] = active_[i] * per_pressure_[i];
}

int FillerMechanics::ever_passive() const {
  return int(std::count_if(slip_.begin(), slip_.end(), [](double s) { return s > 0; }));
}

std::vector<double> FillerMechanics::state() const {
  std::vector<double> all(strain_);
  all.insert(all.end(), grains_.begin(), grains_.end());
  all.insert(all.end(), hoop_.begin(), hoop_.end());
  all.insert(all.end(), lateral_.begin(), lateral_.end());
  for (const Contact c : contact_) all.push_back(double(c));
  all.insert(all.end(), slip_.begin(), slip_.end());
  return all;
}

void FillerMechanics::restore(std::span<const double> state) {
  const std::size_t bed = strain_.size(), grains = grains_.size(), all = hoop_.size();
  if (state.size() != 3 * bed + grains + 2 * all)
    throw Error("filler-mechanics: the checkpoint has another number of rings; run with the same cells.");
  const double* from = state.data();
  const auto take = [&](auto& to, std::size_t n) {
    for (std::size_t i = 0; i < n; ++i) to[i] = from[i];
    from += n;
  };
  take(strain_, bed), take(grains_, grains), take(hoop_, all), take(lateral_, all);
  for (std::size_t i = 0; i < bed; ++i) contact_[i] = Contact(int(*from++));
  take(slip_, bed);
}

std::vector<double> active_hoop(const Rings& rings, const Filler& filler, const InnerPressure& p) {
  std::vector<double> hoop;
  const double ka = rankine_active(filler);
  for (int i = 0; i < rings.size(); ++i)
    hoop.push_back((p.fluid[i] + ka * p.vertical[i]) * rings.diameter / (2 * rings.thickness[i]));
  return hoop;
}

void wall_stress(const Rings& rings, const Steel& steel, const InnerPressure& pressure, double roof_pressure,
                 std::span<const double> hoop, std::span<const double> temperature, WallStress& out) {
  const int n = rings.size();
  for (auto* v : {&out.hoop, &out.axial, &out.radial, &out.equivalent, &out.yield}) v->resize(n);
  double above = roof_pressure * rings.diameter / 4;  // weight above over the circumference [N/m]
  for (int i = n - 1; i >= 0; --i) {
    const double own = steel.density * gravity * rings.thickness[i] * rings.dz[i];
    const double t = hoop[i], r = -pressure.fluid[i], z = -(above + own / 2) / rings.thickness[i];
    above += own;
    out.hoop[i] = t, out.axial[i] = z, out.radial[i] = r;
    out.equivalent[i] = std::sqrt(0.5 * ((t - z) * (t - z) + (z - r) * (z - r) + (r - t) * (r - t)));
    out.yield[i] = steel.yield_strength(temperature[i]);
  }
}

}  // namespace couplet::thermocline
