// SPDX-License-Identifier: Apache-2.0
#include "thermocline/wall/shell.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "common/base/error.hpp"

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

Shell::Shell(const Rings& rings, const Steel& steel)
    : rings_(&rings),
      steel_(&steel),
      specific_heat_of_(steel.specific_heat),
      conductivity_of_(steel.conductivity) {
  const int n = rings.size();
  const double around = std::numbers::pi * rings.diameter;
  for (int i = 0; i < n; ++i) {
    mass_.push_back(steel.density * around * rings.thickness[i] * rings.dz[i]);
    bare_.push_back(rings.dz[i] / (2 * around * rings.thickness[i]));
  }
  temperature_.assign(n, 293.15);
  for (auto* v : {&a_, &b_, &c_, &r_, &coupling_, &specific_heat_, &resistance_}) v->assign(n, 0.0);
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
  specific_heat_of_.values(temperature_.data(), specific_heat_.data(), n);
  conductivity_of_.values(temperature_.data(), resistance_.data(), n);
  for (int i = 0; i < n; ++i) resistance_[i] = bare_[i] / resistance_[i];
  conduction_rows(n, resistance_.data(), a_.data(), c_.data());
  for (int i = 0; i < rings.in_bed; ++i) coupling_[i] = film[i] * around * rings.dz[i];
  // Two passes, so that the specific heat is its mean over the step and the stored heat equals the inflow.
  for (int pass = 0; pass < 2; ++pass) {
    for (int i = 0; i < n; ++i) {
      const double capacity = mass_[i] * specific_heat_[i] / dt;
      b_[i] = capacity - a_[i] - c_[i];  // of the ends: 0
      r_[i] = capacity * temperature_[i] - lost[i];
    }
    for (int i = 0; i < rings.in_bed; ++i) b_[i] += coupling_[i], r_[i] += coupling_[i] * fluid[i];
    matrix_.factorise(a_.data(), b_.data(), c_.data());
    matrix_.solve(r_.data());
    double largest = 0;
    for (int i = 0; i < n; ++i) largest = std::max(largest, std::abs(r_[i] - temperature_[i]));
    if (largest < 0.01 || pass == 1) break;  // then both agree to 1e-6
    specific_heat_of_.means(temperature_.data(), r_.data(), specific_heat_.data(), n);
  }
  temperature_ = r_;
  for (int i = 0; i < rings.in_bed; ++i) from_bed[i] = coupling_[i] * (fluid[i] - temperature_[i]);
}

double Shell::energy(double reference) const {
  double sum = 0;
  const Curve& cp = steel_->specific_heat;
  for (int i = 0; i < rings_->size(); ++i)
    sum += steel_->density * std::numbers::pi * rings_->diameter * rings_->thickness[i] * rings_->dz[i] *
           (cp.integral(temperature_[i]) - cp.integral(reference));
  return sum;
}

void declare(config::Section& s, ExternalWallParameters& p) {
  s.value("sections", p.sections)
      .range(2, 100000)
      .doc("number of faces along the wall, equal to that of the other program's inner surface");
  s.value("angle", p.angle)
      .unit("rad")
      .range(1e-6, 3)
      .doc("angle of the wedge that the other program computes");
}

WallInterface::WallInterface(const ExternalWallParameters& p, const Rings& rings)
    : radius_(rings.diameter / 2),
      angle_(p.angle),
      height_(rings.z.back() + rings.dz.back() / 2),
      sections_(p.sections),
      ring_z_(rings.z),
      ring_dz_(rings.dz) {}

coupling::Interface WallInterface::describe() const {
  coupling::Interface interface;
  interface.dim = 3;
  const double dz = height_ / sections_, half = angle_ / 2, width = 2 * radius_ * std::sin(half);
  for (int k = 0; k <= sections_; ++k)
    for (const double side : {-1.0, 1.0})
      interface.vertices.emplace_back(radius_ * std::cos(half), side * radius_ * std::sin(half), k * dz);
  for (int k = 0; k < sections_; ++k) {
    interface.face_centres.emplace_back(radius_ * std::cos(half), 0, (k + 0.5) * dz);
    interface.face_areas.emplace_back(width * dz, 0, 0);
  }
  return interface;
}

std::vector<double> WallInterface::to_sections(std::span<const double> rings) const {
  const Curve profile(ring_z_, {rings.begin(), rings.end()});
  std::vector<double> values(sections_);
  const double dz = height_ / sections_, from = ring_z_.front();
  for (int k = 0; k < sections_; ++k) {
    // The table is constant below its first ring, where its integral starts.
    const double low = k * dz, high = low + dz;
    values[k] = high <= from ? profile(low) : (profile.integral(high) - profile.integral(low)) / dz;
  }
  return values;
}

std::vector<double> WallInterface::to_rings(std::span<const double> amounts) const {
  std::vector<double> values(ring_z_.size());
  const double dz = height_ / sections_;
  for (std::size_t i = 0; i < ring_z_.size(); ++i) {
    const double low = ring_z_[i] - ring_dz_[i] / 2, high = low + ring_dz_[i];
    const int last = std::min(sections_ - 1, int(high / dz));
    for (int k = std::max(0, int(low / dz)); k <= last; ++k)
      values[i] += amounts[k] * std::max(0.0, std::min(high, (k + 1) * dz) - std::max(low, k * dz)) / dz;
  }
  return values;
}

std::vector<double> WallInterface::radial(std::span<const double> displacement) const {
  if (displacement.size() != std::size_t(6 * (sections_ + 1)))
    throw Error("The wall gave {} values of displacement, but its {} vertices need {}.", displacement.size(),
                2 * (sections_ + 1), 6 * (sections_ + 1));
  std::vector<double> z, u;
  const double c = std::cos(angle_ / 2), s = std::sin(angle_ / 2);
  for (int k = 0; k <= sections_; ++k) {
    const double* d = displacement.data() + 6 * k;
    z.push_back(k * height_ / sections_);
    u.push_back(0.5 * ((d[0] * c - d[1] * s) + (d[3] * c + d[4] * s)));
  }
  const Curve profile(std::move(z), std::move(u));
  std::vector<double> values;
  for (const double at : ring_z_) values.push_back(profile(at));
  return values;
}

void declare(config::Section& section, ShellParameters& p) {
  declare_section(section, "material", p.material, "metal of the shell");
  section.list<Plate>(
      "plates", p.plates,
      [](config::Section& s, Plate& l) {
        as_length(s.value("height", l.height)).positive().required().doc("height");
        s.value("thickness", l.thickness).unit("m", 1e-4, 1).positive().required().doc("thickness");
      },
      "plates from the bottom up; the last one continues to the top");
  section.check([&p] { return p.plates.empty() ? "at least one plate is needed" : ""; }, "plates");
}

}  // namespace couplet::thermocline
