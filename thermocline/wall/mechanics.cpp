// SPDX-License-Identifier: Apache-2.0
#include "thermocline/wall/mechanics.hpp"

#include <Eigen/SparseCholesky>
#include <algorithm>
#include <array>
#include <cmath>

#include "common/base/error.hpp"

namespace couplet::thermocline {

double rankine_active(const Filler& filler) {
  const double s = std::sin(filler.friction_angle);
  return (1 - s) / (1 + s);
}

InnerPressure inner_pressure(const Rings& rings, const BedGrid& bed, const Medium& fluid,
                             const Filler& filler, double ullage_gauge, std::span<const double> temperature) {
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
                                 std::span<const double> grains, bool is_external)
    : rings_(&rings),
      steel_(&steel),
      expansion_(filler.expansion),
      active_ratio_(rankine_active(filler)),
      begun_(!is_external),
      slip_(rings.in_bed, 0.0),
      grains_(grains.begin(), grains.end()),
      given_wall_(wall.begin(), wall.end()),
      contact_(rings.in_bed, Contact::active) {
  for (auto* v : {&fluid_, &active_, &passive_, &hoop_, &total_}) v->assign(rings.size(), 0.0);
  load(p);
  lateral_ = active_;
  for (int i = 0; i < rings.in_bed; ++i)
    strain_.push_back((fluid_[i] + active_[i]) / stiffness(i, wall[i]) + steel.thermal_strain(wall[i]));
  finish();
}

/// Pressure per strain of a ring at its temperature [Pa].
double FillerMechanics::stiffness(int ring, double temperature) const {
  return steel_->youngs_modulus(temperature) * 2 * rings_->thickness[ring] / rings_->diameter;
}

void FillerMechanics::load(const InnerPressure& p) {
  for (std::size_t i = 0; i < fluid_.size(); ++i) {
    fluid_[i] = p.fluid[i];
    active_[i] = active_ratio_ * p.vertical[i];
    passive_[i] = p.vertical[i] / active_ratio_;
  }
}

void FillerMechanics::finish() {
  for (int i = 0; i < rings_->size(); ++i) {
    total_[i] = fluid_[i] + lateral_[i];
    hoop_[i] = total_[i] * rings_->diameter / (2 * rings_->thickness[i]);
  }
}

void FillerMechanics::update(std::span<const double> wall, std::span<const double> grains,
                             std::span<const double> radial) {
  const double radius = rings_->diameter / 2;
  for (int i = 0; i < rings_->in_bed; ++i) {
    const double per_strain = stiffness(i, wall[i]), free = steel_->thermal_strain(wall[i]);
    const double of_wall =
        radial.empty() ? (fluid_[i] + lateral_[i]) / per_strain + free
                       : std::log1p(radial[i] / radius) + free - steel_->thermal_strain(given_wall_[i]);
    if (!begun_) strain_[i] = of_wall;
    // (5.18) as D exp(alpha dT); the printed D (1 + alpha dT) would decrease in a cycle.
    strain_[i] += expansion_ * (grains[i] - grains_[i]);
    grains_[i] = grains[i];
    const double wanted = lateral_[i] + per_strain * (strain_[i] - of_wall);
    lateral_[i] = std::clamp(wanted, active_[i], passive_[i]);
    contact_[i] = wanted <= active_[i]    ? Contact::active
                  : wanted >= passive_[i] ? Contact::passive
                                          : Contact::rigid;
    // If the bound limits the pressure, the filler follows the wall under that bound: the grains slump, or
    // the wall pushes them.
    strain_[i] -= (wanted - lateral_[i]) / per_strain;
    slip_[i] += std::max(0.0, wanted - passive_[i]) / per_strain;
  }
  given_wall_.assign(wall.begin(), wall.end());
  begun_ = begun_ || !radial.empty();
  finish();
}

std::vector<double> active_hoop(const Rings& rings, const Filler& filler, const InnerPressure& p) {
  std::vector<double> hoop;
  const double ka = rankine_active(filler);
  for (int i = 0; i < rings.size(); ++i)
    hoop.push_back((p.fluid[i] + ka * p.vertical[i]) * rings.diameter / (2 * rings.thickness[i]));
  return hoop;
}

void wall_stress(const Rings& rings, const Steel& steel, const InnerPressure& pressure,
                 std::span<const double> hoop, std::span<const double> temperature, WallStress& out) {
  const int n = rings.size();
  for (auto* v : {&out.hoop, &out.axial, &out.radial, &out.equivalent, &out.yield}) v->resize(n);
  double above = 0;  // weight above over the circumference [N/m]
  for (int i = n - 1; i >= 0; --i) {
    const double own = steel.density * gravity * rings.thickness[i] * rings.dz[i];
    const double t = hoop[i], r = -pressure.fluid[i], z = -(above + own / 2) / rings.thickness[i];
    above += own;
    out.hoop[i] = t, out.axial[i] = z, out.radial[i] = r;
    out.equivalent[i] = std::sqrt(0.5 * ((t - z) * (t - z) + (z - r) * (z - r) + (r - t) * (r - t)));
    out.yield[i] = steel.yield_strength(temperature[i]);
  }
}

WallBending wall_bending(const Rings& rings, const Steel& steel, std::span<const double> hoop,
                         std::span<const double> temperature) {
  const std::size_t n = rings.z.size();
  const double a = rings.diameter / 2, nu = steel.poissons_ratio;
  std::vector<double> modulus(n), free(n), stiffness(n);
  std::vector<Eigen::Triplet<double>> entries;
  Eigen::VectorXd w(n);
  const double start = steel.thermal_strain(temperature[0]);
  for (std::size_t i = 0; i < n; ++i) {
    const double e = rings.thickness[i];
    modulus[i] = steel.youngs_modulus(temperature[i]);
    free[i] = steel.thermal_strain(temperature[i]) - start;
    const double support = modulus[i] * e / (a * a) * rings.dz[i];
    stiffness[i] = modulus[i] * e * e * e / (12 * (1 - nu * nu));
    entries.emplace_back(i, i, support);
    w[i] = support * a * (hoop[i] / modulus[i] + free[i]);
  }
  // Minimizes 1/2 sum D (w'')^2 dz + 1/2 sum E e/a^2 (w - w_m)^2 dz, w'' at inner rings from three values.
  std::vector<std::array<double, 3>> curvature(n, {0, 0, 0});
  for (std::size_t i = 1; i + 1 < n; ++i) {
    const double below = rings.z[i] - rings.z[i - 1], above = rings.z[i + 1] - rings.z[i],
                 both = below + above;
    curvature[i] = {2 / (below * both), -2 / (below * above), 2 / (above * both)};
    for (std::size_t p = 0; p < 3; ++p)
      for (std::size_t q = 0; q < 3; ++q)
        entries.emplace_back(i + p - 1, i + q - 1,
                             stiffness[i] * 0.5 * both * curvature[i][p] * curvature[i][q]);
  }
  Eigen::SparseMatrix<double> matrix(n, n);
  matrix.setFromTriplets(entries.begin(), entries.end());
  w = Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>>(matrix).solve(w).eval();
  WallBending result{std::vector<double>(n), std::vector<double>(n, 0.0)};
  for (std::size_t i = 0; i < n; ++i) {
    result.hoop[i] = modulus[i] * (w[i] / a - free[i]);
    if (i == 0 || i + 1 == n) continue;
    const auto& [before, here, after] = curvature[i];
    const double bent = before * w[i - 1] + here * w[i] + after * w[i + 1];
    // With outward curvature (w'' > 0) the outer face is in compression.
    result.axial[i] = -6 * stiffness[i] * bent / (rings.thickness[i] * rings.thickness[i]);
  }
  return result;
}

YieldShares yield_shares(const WallStress& stress, const WallBending& bent, double poissons_ratio) {
  YieldShares shares;
  for (std::size_t i = 0; i < stress.hoop.size(); ++i) {
    shares.rings = std::max(shares.rings, stress.equivalent[i] / stress.yield[i]);
    for (const double face : {-1.0, 1.0}) {
      const double added = face * bent.axial[i], r = stress.radial[i];
      const double t = bent.hoop[i] + poissons_ratio * added, z = stress.axial[i] + added;
      const double equivalent = std::sqrt(0.5 * ((t - z) * (t - z) + (z - r) * (z - r) + (r - t) * (r - t)));
      shares.shell = std::max(shares.shell, equivalent / stress.yield[i]);
    }
  }
  return shares;
}

}  // namespace couplet::thermocline
