// SPDX-License-Identifier: Apache-2.0
#include "thermocline/bed/packed_bed.hpp"

#include <algorithm>
#include <cmath>

#include "thermocline/bed/grains.hpp"

namespace couplet::thermocline {
namespace {

/// Half the limited difference at a cell (van Leer): harmonic mean of the differences on both sides.
inline double half_slope(double behind, double ahead) {
  const double product = behind * ahead;
  const double divisor = product > 0 ? behind + ahead : 1;
  return (product > 0 ? product : 0) / divisor;
}

struct Range {
  double low, high;
  void add(const double* values, std::size_t n) {
    double a = low, b = high;
    for (std::size_t i = 0; i < n; ++i) a = std::min(a, values[i]), b = std::max(b, values[i]);
    low = a, high = b;
  }
};

}  // namespace

GrainCells PackedBed::cells_of(const BedOperator& op, const BedGrid::Run& run) const {
  return {op.rate.data(),
          op.share.data(),
          op.beta.data(),
          op.heat.data(),
          std::size_t(run.first),
          std::size_t(run.first + run.count),
          std::size_t(c_->grid.size())};
}

void PackedBed::solve(const BedOperator& op, double* fluid, const double* shells, double* to_shells,
                      const double* extra) {
  for (std::size_t r = 0; r < c_->grid.runs.size(); ++r)
    gather_grains(op.grains[r], cells_of(op, c_->grid.runs[r]), shells, extra, fluid, work_.sums.data());
  op.matrix.solve(fluid);
  for (std::size_t r = 0; r < c_->grid.runs.size(); ++r)
    scatter_grains(op.grains[r], cells_of(op, c_->grid.runs[r]), shells, fluid, to_shells, work_.sums.data());
}

double PackedBed::explicit_terms(const double* t, double flux, double inlet, bool second_order) {
  const int n = c_->grid.size();
  if (flux == 0) {
    std::copy(source_.begin(), source_.end(), work_.extra.begin());
    return inlet;
  }
  const bool up = flux > 0;
  const double gc = flux * c_->fluid.specific_heat;
  // Temperature transported across face i (below cell i), from the upwind side.
  double* face = work_.face.data();
  std::copy_n(t, n, up ? face + 1 : face);
  face[up ? 0 : n] = inlet;
  if (second_order && n > 1) {
    if (up) {
      for (int i = 2; i < n; ++i) face[i] += half_slope(t[i - 1] - t[i - 2], t[i] - t[i - 1]);
      face[1] += half_slope(2 * (t[0] - inlet), t[1] - t[0]);
    } else {
      for (int i = 1; i < n - 1; ++i) face[i] += half_slope(t[i] - t[i + 1], t[i - 1] - t[i]);
      face[n - 1] += half_slope(2 * (t[n - 1] - inlet), t[n - 2] - t[n - 1]);
    }
  }
  for (int i = 0; i < n; ++i) work_.extra[i] = source_[i] + gc * (face[i] - face[i + 1]);
  return up ? face[n] : face[0];
}

BedHeat PackedBed::first_order_step(const BedOperator& op, double flux, double inlet, bool second_order) {
  const int n = c_->grid.size();
  double outlet = inlet;
  const double through_inlet = flux != 0 ? inlet_conductance(flux > 0) : 0;
  const int entry = flux > 0 ? 0 : n - 1, exit = flux > 0 ? n - 1 : 0;
  if (c_->advection == Advection::implicit) {
    std::copy(source_.begin(), source_.end(), work_.extra.begin());
    work_.extra[entry] += std::abs(flux) * c_->fluid.specific_heat * inlet;
  } else {
    outlet = explicit_terms(fluid_.data(), flux, inlet, second_order);
  }
  work_.extra[entry] += through_inlet * inlet;
  if (is_nonlinear()) {
    solve_nonlinear(op, work_.extra.data());
  } else {
    solve(op, fluid_.data(), shell_.data(), shell_.data(), work_.extra.data());
  }
  if (c_->advection == Advection::implicit && flux != 0) outlet = fluid_[exit];
  const double conducted = through_inlet * (inlet - fluid_[entry]);
  BedHeat heat;
  heat.outlet = outlet;
  heat.by_flow =
      c_->area * prepared_.dt * (std::abs(flux) * c_->fluid.specific_heat * (inlet - outlet) + conducted);
  return heat;
}

/// IMEX-SSP2(2,2,2) of Pareschi and Russo (2005), second order: Heun's strong-stability-preserving method for
/// advection, and an L-stable SDIRK with gamma = 1 - 1/sqrt(2) for conduction and exchange:
///   U1 = u + gamma dt L U1
///   U2 = u + dt A(U1) + dt (1 - 2 gamma) L U1 + gamma dt L U2
///   u' = u + dt/2 (A(U1) + A(U2)) + dt/2 (L U1 + L U2)
/// Returns false, with the state unchanged, if the result leaves the range of the input, which is possible
/// for fast exchange.
///
/// L is eliminated: gamma dt L U1 = U1 - u and gamma dt L U2 = U2 - R2 with the right-hand side R2 of U2,
/// hence u' = u + dt/2 (A(U1) + A(U2)) + (U1 - u + U2 - R2)/(2 gamma).
bool PackedBed::second_order_step(double flux, double inlet, BedHeat& heat) {
  const std::size_t n = fluid_.size(), ns = shell_.size();
  const double gamma = prepared_.main.tau / prepared_.dt, carry = (1 - 2 * gamma) / gamma, half = 0.5 / gamma;
  const double through_inlet = flux != 0 ? inlet_conductance(flux > 0) : 0;
  const std::size_t entry = flux > 0 ? 0 : n - 1;
  // Conduction through the inlet is part of L.
  const auto only_inlet = [&] {
    std::fill(work_.extra.begin(), work_.extra.end(), 0.0);
    work_.extra[entry] = through_inlet * inlet;
  };
  std::copy(fluid_.begin(), fluid_.end(), work_.fluid1.begin());
  only_inlet();
  solve(prepared_.main, work_.fluid1.data(), shell_.data(), work_.shell1.data(), work_.extra.data());
  const double conducted1 = through_inlet * (inlet - work_.fluid1[entry]);
  const double first = explicit_terms(work_.fluid1.data(), flux, inlet, true);
  // R2 in work_.fluid2, work_.shell2; work_.fluid1 contains the known part of u'.
  for (std::size_t i = 0; i < n; ++i) {
    const double a = prepared_.dt / capacity_[i] * work_.extra[i], l = work_.fluid1[i] - fluid_[i];
    work_.fluid2[i] = fluid_[i] + a + carry * l;
    work_.fluid1[i] = fluid_[i] + 0.5 * a + half * (l - work_.fluid2[i]);
  }
  for (std::size_t i = 0; i < ns; ++i) work_.shell2[i] = shell_[i] + carry * (work_.shell1[i] - shell_[i]);
  only_inlet();
  solve(prepared_.main, work_.fluid2.data(), work_.shell2.data(), work_.shell2.data(), work_.extra.data());
  const double conducted2 = through_inlet * (inlet - work_.fluid2[entry]);
  const double second = explicit_terms(work_.fluid2.data(), flux, inlet, true);
  Range before{flux != 0 ? inlet : fluid_[0], flux != 0 ? inlet : fluid_[0]};
  before.add(fluid_.data(), n);
  before.add(shell_.data(), ns);
  for (std::size_t i = 0; i < n; ++i)
    work_.fluid1[i] += half * work_.fluid2[i] + 0.5 * prepared_.dt / capacity_[i] * work_.extra[i];
  // u + (U1 - u + U2 - R2)/(2 gamma) with R2 = u + carry (U1 - u).
  const double of_u = 1 - half * (2 - carry), of_u1 = half * (1 - carry);
  for (std::size_t i = 0; i < ns; ++i)
    work_.shell1[i] = of_u * shell_[i] + of_u1 * work_.shell1[i] + half * work_.shell2[i];
  Range after{before.low, before.high};
  after.add(work_.fluid1.data(), n);
  after.add(work_.shell1.data(), ns);
  const double slack = 1e-9 * (before.high - before.low) + 1e-11 * before.high + source_rate_ * prepared_.dt;
  if (!(after.low >= before.low - slack && after.high <= before.high + slack)) return false;
  fluid_.swap(work_.fluid1);
  shell_.swap(work_.shell1);
  heat.outlet = 0.5 * (first + second);
  heat.by_flow =
      c_->area * prepared_.dt *
      (std::abs(flux) * c_->fluid.specific_heat * (inlet - heat.outlet) + 0.5 * (conducted1 + conducted2));
  return true;
}

BedHeat PackedBed::step(double mass_flow, double inlet) {
  // The matrix of the implicit scheme depends on the flow.
  const double flux = mass_flow / c_->area;
  const bool other_inlet = c_->conducting_inlet && ((flux > 0) != (prepared_.mass_flow > 0) ||
                                                    (flux < 0) != (prepared_.mass_flow < 0));
  if ((c_->advection == Advection::implicit && mass_flow != prepared_.mass_flow) || other_inlet)
    prepare(prepared_.dt, mass_flow);
  BedHeat heat;
  ++steps_;
  if (c_->advection != Advection::tvd) {
    heat = first_order_step(prepared_.main, flux, inlet, false);
  } else if (!second_order_step(flux, inlet, heat)) {
    if (prepared_.fallback.grains.empty()) build(prepared_.fallback, prepared_.dt);
    ++fallbacks_;
    heat = first_order_step(prepared_.fallback, flux, inlet, true);
  }
  double source = 0;
  for (const double s : source_) source += s;
  heat.by_source = c_->area * prepared_.dt * source;
  return heat;
}

// Grains that melt or have a specific heat by temperature use Newton's method for the heat of each shell [swaminathan1993]. With h_m, T_m of the
// last pass and c = dh/dT,
//   (h_m + c (T - T_m) - h^n)/tau = inflow at T
// is linear. h_m + c (T - T_m) then equals the inflow exactly after any number of passes, and T_{m+1} is its
// temperature. The conductivity of the grains is that of the old temperatures.

/// Apparent capacity and right-hand side of each shell at its temperature of the last pass [J/(m^3 K)],
/// [J/m^3].
void PackedBed::linearise(const BedGrid::Run& run, const GrainHeat& content) {
  const int n = c_->grid.size();
  const double share = (1 - run.layer.porosity) / c_->shells;
  for (int j = 0; j < c_->shells; ++j)
    for (int i = run.first; i < run.first + run.count; ++i) {
      const std::size_t k = std::size_t(j) * n + i;
      const double c = content.capacity(shell_[k]);
      work_.nonlinear.capacity[k] = share * c;
      work_.nonlinear.right[k] =
          share * (c * shell_[k] - content.heat(shell_[k]) + content.heat(work_.shell1[k]));
    }
}

/// GrainElimination with a capacity per shell and cell; adds to the fluid's rows.
void PackedBed::eliminate(const BedOperator& op, std::size_t r, const double* extra) {
  const BedGrid::Run& run = c_->grid.runs[r];
  const Grains& grains = c_->grains[r];
  const int n = c_->grid.size();
  const fv::Property& conductivity = c_->fillers[r].conductivity;
  const double nominal = value_of(conductivity, c_->nominal);
  const std::vector<double>& old = work_.shell1;
  const auto ratio = [&](std::size_t a, std::size_t b) {  // at the mean temperature of two shells
    return conductivity.is_constant() ? 1 : value_of(conductivity, 0.5 * (old[a] + old[b])) / nominal;
  };
  const auto between = [&](int j, int i) {  // shells j and j + 1 of cell i
    const std::size_t k = std::size_t(j) * n + i;
    return grains.between[j] * ratio(k, k + n);
  };
  for (int i = run.first; i < run.first + run.count; ++i) {
    double rest_inside = 1, inside = 0;  // 1 - beta and alpha of the shell further in
    for (int j = c_->shells - 1; j >= 1; --j) {
      const std::size_t k = std::size_t(j) * n + i;
      const double outward = between(j - 1, i), inward = j + 1 < c_->shells ? between(j, i) : 0;
      const double held = work_.nonlinear.capacity[k] / op.tau + inward * rest_inside,
                   diagonal = held + outward;
      work_.nonlinear.alpha[k] = inside = (work_.nonlinear.right[k] / op.tau + inward * inside) / diagonal;
      work_.nonlinear.beta[k] = outward / diagonal;
      rest_inside = held / diagonal;
    }
    const double inward = c_->shells > 1 ? between(0, i) : 0;
    const double own = work_.nonlinear.capacity[i] / op.tau + inward * rest_inside;
    const double g = grains.exchange(prepared_.film[i], ratio(i, i)), dz = c_->grid.dz[i];
    work_.nonlinear.alpha[i] = (work_.nonlinear.right[i] / op.tau + inward * inside) / (own + g);
    work_.nonlinear.beta[i] = g / (own + g);
    work_.nonlinear.diagonal[i] =
        work_.diagonal[i] - op.grains[r].own * op.heat[i] + own * work_.nonlinear.beta[i] * dz;
    fluid_[i] = op.rate[i] * fluid_[i] + extra[i] + g * dz * work_.nonlinear.alpha[i];
  }
}

/// Computes the temperatures for the heat received by each shell. Returns the largest error of the linearized
/// ones [K].
double PackedBed::settle(const BedGrid::Run& run, const GrainHeat& content) {
  const int n = c_->grid.size();
  const double share = (1 - run.layer.porosity) / c_->shells;
  double worst = 0;
  for (int i = run.first; i < run.first + run.count; ++i) {
    double outside = fluid_[i];
    for (int j = 0; j < c_->shells; ++j) {
      const std::size_t k = std::size_t(j) * n + i;
      outside = work_.nonlinear.alpha[k] + work_.nonlinear.beta[k] * outside;
      // capacity T - right = h - h^n, per volume of the bed.
      const double heat = content.heat(work_.shell1[k]) +
                          (work_.nonlinear.capacity[k] * outside - work_.nonlinear.right[k]) / share;
      shell_[k] = content.temperature(heat);
      worst = std::max(worst, std::abs(shell_[k] - outside));
    }
  }
  return worst;
}

void PackedBed::solve_nonlinear(const BedOperator& op, const double* extra) {
  constexpr int most_passes = 30;
  constexpr double close = 1e-6;  // [K]
  work_.fluid1 = fluid_, work_.shell1 = shell_;
  for (int pass = 0; pass < most_passes; ++pass) {
    fluid_ = work_.fluid1;
    work_.nonlinear.diagonal = work_.diagonal;
    for (std::size_t r = 0; r < c_->grid.runs.size(); ++r) {
      const BedGrid::Run& run = c_->grid.runs[r];
      if (!c_->heat[r]) {
        gather_grains(op.grains[r], cells_of(op, run), work_.shell1.data(), extra, fluid_.data(),
                      work_.sums.data());
        continue;
      }
      linearise(run, *c_->heat[r]);
      eliminate(op, r, extra);
    }
    work_.nonlinear.matrix.resize(c_->grid.size());
    work_.nonlinear.matrix.factorise(work_.lower.data(), work_.nonlinear.diagonal.data(), work_.upper.data());
    work_.nonlinear.matrix.solve(fluid_.data());
    double worst = 0;
    for (std::size_t r = 0; r < c_->grid.runs.size(); ++r) {
      const BedGrid::Run& run = c_->grid.runs[r];
      if (c_->heat[r])
        worst = std::max(worst, settle(run, *c_->heat[r]));
      else
        scatter_grains(op.grains[r], cells_of(op, run), work_.shell1.data(), fluid_.data(), shell_.data(),
                       work_.sums.data());
    }
    if (worst <= close) return;
  }
  ++fallbacks_;  // the books are right all the same
}

}  // namespace couplet::thermocline
