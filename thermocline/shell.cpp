// SPDX-License-Identifier: Apache-2.0
#include "thermocline/shell.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace couplet::thermocline {

Rings::Rings(const ShellParameters& p, const BedGrid& bed, double d, double above)
    : diameter(d), in_bed(bed.size()), z(bed.z), dz(bed.dz) {
  if (above > 0) {
    const int more = std::max(1, int(std::lround(above / bed.dz.back())));
    for (int i = 0; i < more; ++i) {
      dz.push_back(above / more);
      z.push_back(bed.height + (i + 0.5) * above / more);
    }
  }
  for (const double height : z) {
    double top = 0;
    thickness.push_back(p.plates.back().thickness);
    for (const Plate& plate : p.plates) {
      top += plate.height;
      if (height < top) {
        thickness.back() = plate.thickness;
        break;
      }
    }
  }
}

double Rings::surface(int i) const { return std::numbers::pi * diameter * dz[i]; }

Shell::Shell(const Rings& rings, const Steel& steel) : rings_(&rings), steel_(&steel) {
  const int n = rings.size();
  temperature_.assign(n, 293.15);
  for (auto* v : {&a_, &b_, &c_, &r_, &capacity_, &specific_heat_, &resistance_}) v->assign(n, 0.0);
  matrix_.resize(n);
}

void Shell::set_temperature(std::span<const double> temperature) {
  std::copy(temperature.begin(), temperature.end(), temperature_.begin());
}

void Shell::step(double dt, std::span<const double> fluid, std::span<const double> film,
                 std::span<const double> lost, std::vector<double>& from_bed) {
  const Rings& rings = *rings_;
  const int n = rings.size();
  const double around = std::numbers::pi * rings.diameter;
  for (int i = 0; i < n; ++i) {
    specific_heat_[i] = steel_->specific_heat(temperature_[i]);
    resistance_[i] = rings.dz[i] / (2 * steel_->conductivity(temperature_[i]) * around *
                                    rings.thickness[i]);  // half a ring
  }
  // Twice, so that the specific heat is its mean over the step: what is stored is then exactly what came in.
  for (int pass = 0; pass < 2; ++pass) {
    double below = 0;
    for (int i = 0; i < n; ++i) {
      capacity_[i] = steel_->density * around * rings.thickness[i] * rings.dz[i] * specific_heat_[i] / dt;
      b_[i] = capacity_[i] + below;
      r_[i] = capacity_[i] * temperature_[i] - lost[i];
      if (i < rings.in_bed) {
        const double g = film[i] * rings.surface(i);
        b_[i] += g;
        r_[i] += g * fluid[i];
      }
      if (i + 1 == n) break;
      below = 1 / (resistance_[i] + resistance_[i + 1]);
      c_[i] = a_[i + 1] = -below;
      b_[i] += below;
    }
    matrix_.factorise(a_.data(), b_.data(), c_.data());
    matrix_.solve(r_.data());
    double largest = 0;
    const Table& cp = steel_->specific_heat;
    for (int i = 0; i < n && pass == 0; ++i) {
      const double change = r_[i] - temperature_[i];
      largest = std::max(largest, std::abs(change));
      if (std::abs(change) > 1e-6)
        specific_heat_[i] = (cp.integral(r_[i]) - cp.integral(temperature_[i])) / change;
    }
    if (largest < 0.01) break;  // then both agree to 1e-6
  }
  temperature_ = r_;
  for (int i = 0; i < rings.in_bed; ++i)
    from_bed[i] = film[i] * rings.surface(i) * (fluid[i] - temperature_[i]);
}

double Shell::energy(double reference) const {
  double sum = 0;
  const Table& cp = steel_->specific_heat;
  for (int i = 0; i < rings_->size(); ++i)
    sum += steel_->density * std::numbers::pi * rings_->diameter * rings_->thickness[i] * rings_->dz[i] *
           (cp.integral(temperature_[i]) - cp.integral(reference));
  return sum;
}

}  // namespace couplet::thermocline
