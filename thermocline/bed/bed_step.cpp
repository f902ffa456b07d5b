// SPDX-License-Identifier: Apache-2.0
#include "thermocline/bed/packed_bed.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "thermocline/bed/grains.hpp"

namespace couplet::thermocline {
namespace {

/// Half the limited difference at a cell, van Leer: the harmonic mean of the differences on its two sides.
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

GrainCells PackedBed::cells_of(const Operator& op, const BedGrid::Run& run) const {
  return {op.rate.data(),           op.share.data(),        op.beta.data(),
          op.heat.data(),           std::size_t(run.first), std::size_t(run.first + run.count),
          std::size_t(grid_.size())};
}

void PackedBed::solve(const Operator& op, double* fluid, const double* shells, double* to_shells,
                      const double* extra, bool sums_are_known) {
  for (std::size_t r = 0; r < grid_.runs.size(); ++r) {
    if (sums_are_known)
      gather_sums(cells_of(op, grid_.runs[r]), extra, fluid, sums_.data());
    else
      gather_grains(op.grains[r], cells_of(op, grid_.runs[r]), shells, extra, fluid, sums_.data());
  }
  op.matrix.solve(fluid);
  for (std::size_t r = 0; r < grid_.runs.size(); ++r)
    scatter_grains(op.grains[r], cells_of(op, grid_.runs[r]), shells, fluid, to_shells, sums_.data());
}

PackedBed::Stage PackedBed::explicit_terms(const double* t, double flux, double inlet, bool second_order) {
  const int n = grid_.size();
  Stage stage;
  stage.outlet = inlet;
  if (flux == 0) {
    std::copy(source_.begin(), source_.end(), extra_.begin());
    return stage;
  }
  const bool up = flux > 0;
  const double gc = flux * liquid_.specific_heat;
  if (!second_order) {
    const double* q = source_.data();
    if (up) {
      extra_[0] = q[0] + gc * (inlet - t[0]);
      for (int i = 1; i < n; ++i) extra_[i] = q[i] + gc * (t[i - 1] - t[i]);
    } else {
      for (int i = 0; i + 1 < n; ++i) extra_[i] = q[i] + gc * (t[i] - t[i + 1]);
      extra_[n - 1] = q[n - 1] + gc * (t[n - 1] - inlet);
    }
    stage.outlet = up ? t[n - 1] : t[0];
    return stage;
  }
  double* face = face_.data();
  // Temperature that crosses face i (below cell i), from the side where the flow comes from.
  if (up) {
    for (int i = 1; i <= n; ++i) face[i] = t[i - 1];
    for (int i = 2; i < n; ++i) face[i] += half_slope(t[i - 1] - t[i - 2], t[i] - t[i - 1]);
    if (n > 1) face[1] += half_slope(2 * (t[0] - inlet), t[1] - t[0]);
    face[0] = inlet;
  } else {
    for (int i = 0; i < n; ++i) face[i] = t[i];
    for (int i = 1; i < n - 1; ++i) face[i] += half_slope(t[i] - t[i + 1], t[i - 1] - t[i]);
    if (n > 1) face[n - 1] += half_slope(2 * (t[n - 1] - inlet), t[n - 2] - t[n - 1]);
    face[n] = inlet;
  }
  for (int i = 0; i < n; ++i) extra_[i] = source_[i] + gc * (face[i] - face[i + 1]);
  stage.outlet = up ? face[n] : face[0];
  return stage;
}

PackedBed::StepHeat PackedBed::first_order_step(const Operator& op, double flux, double inlet,
                                                bool second_order) {
  const int n = grid_.size();
  Stage stage{inlet, 0};
  const double through_inlet = flux != 0 ? inlet_conductance(flux > 0) : 0;
  const int entry = flux > 0 ? 0 : n - 1, exit = flux > 0 ? n - 1 : 0;
  if (advection_ == Advection::implicit) {
    std::copy(source_.begin(), source_.end(), extra_.begin());
    extra_[entry] += std::abs(flux) * liquid_.specific_heat * inlet;
  } else {
    stage = explicit_terms(fluid_.data(), flux, inlet, second_order);
  }
  extra_[entry] += through_inlet * inlet;
  if (!melting_.empty()) {
    solve_with_melting(op, extra_.data());
  } else {
    solve(op, fluid_.data(), shell_.data(), shell_.data(), extra_.data(), sums_of_ == op.number);
    sums_of_ = op.number;
  }
  if (advection_ == Advection::implicit && flux != 0) stage.outlet = fluid_[exit];
  stage.conducted = through_inlet * (inlet - fluid_[entry]);
  StepHeat heat;
  heat.outlet = stage.outlet;
  heat.by_flow = area_ * prepared_.dt *
                 (std::abs(flux) * liquid_.specific_heat * (inlet - stage.outlet) + stage.conducted);
  return heat;
}

/// IMEX-SSP2(2,2,2) of Pareschi and Russo (2005): Heun's strong-stability-preserving method for advection, an
/// L-stable SDIRK with gamma = 1 - 1/sqrt(2) for conduction and exchange, second order together:
///   U1 = u + gamma dt L U1
///   U2 = u + dt A(U1) + dt (1 - 2 gamma) L U1 + gamma dt L U2
///   u' = u + dt/2 (A(U1) + A(U2)) + dt/2 (L U1 + L U2)
/// False if the result leaves the range of what went in, which second order cannot exclude for exchange much
/// faster than the step; the state is then as before.
///
/// Written without L: gamma dt L U1 = U1 - u, gamma dt L U2 = U2 - R2 with R2 the right-hand side of U2,
/// hence u' = u + dt/2 (A(U1) + A(U2)) + (U1 - u + U2 - R2)/(2 gamma).
bool PackedBed::second_order_step(double flux, double inlet, StepHeat& heat) {
  const std::size_t n = fluid_.size(), ns = shell_.size();
  const double gamma = main_.tau / prepared_.dt, carry = (1 - 2 * gamma) / gamma, half = 0.5 / gamma;
  const double through_inlet = flux != 0 ? inlet_conductance(flux > 0) : 0;
  const std::size_t entry = flux > 0 ? 0 : n - 1;
  // What enters by conduction counts as part of L.
  const auto only_inlet = [&] {
    std::fill(extra_.begin(), extra_.end(), 0.0);
    extra_[entry] = through_inlet * inlet;
  };
  std::copy(fluid_.begin(), fluid_.end(), fluid1_.begin());
  only_inlet();
  sums_of_ = 0;
  solve(main_, fluid1_.data(), shell_.data(), shell1_.data(), extra_.data(), false);
  const double conducted1 = through_inlet * (inlet - fluid1_[entry]);
  const Stage first = explicit_terms(fluid1_.data(), flux, inlet, true);
  // R2 in fluid2_, shell2_; fluid1_ becomes u' as far as it is known.
  for (std::size_t i = 0; i < n; ++i) {
    const double a = prepared_.dt / capacity_[i] * extra_[i], l = fluid1_[i] - fluid_[i];
    fluid2_[i] = fluid_[i] + a + carry * l;
    fluid1_[i] = fluid_[i] + 0.5 * a + half * (l - fluid2_[i]);
  }
  for (std::size_t i = 0; i < ns; ++i) shell2_[i] = shell_[i] + carry * (shell1_[i] - shell_[i]);
  only_inlet();
  solve(main_, fluid2_.data(), shell2_.data(), shell2_.data(), extra_.data(), false);
  const double conducted2 = through_inlet * (inlet - fluid2_[entry]);
  const Stage second = explicit_terms(fluid2_.data(), flux, inlet, true);
  Range before{flux != 0 ? inlet : fluid_[0], flux != 0 ? inlet : fluid_[0]};
  before.add(fluid_.data(), n);
  before.add(shell_.data(), ns);
  for (std::size_t i = 0; i < n; ++i)
    fluid1_[i] += half * fluid2_[i] + 0.5 * prepared_.dt / capacity_[i] * extra_[i];
  // u + (U1 - u + U2 - R2)/(2 gamma) with R2 = u + carry (U1 - u).
  const double of_u = 1 - half * (2 - carry), of_u1 = half * (1 - carry);
  for (std::size_t i = 0; i < ns; ++i) shell1_[i] = of_u * shell_[i] + of_u1 * shell1_[i] + half * shell2_[i];
  Range after{before.low, before.high};
  after.add(fluid1_.data(), n);
  after.add(shell1_.data(), ns);
  const double slack = 1e-9 * (before.high - before.low) + 1e-11 * before.high + source_rate_ * prepared_.dt;
  if (!(after.low >= before.low - slack && after.high <= before.high + slack)) return false;
  fluid_.swap(fluid1_);
  shell_.swap(shell1_);
  heat.outlet = 0.5 * (first.outlet + second.outlet);
  heat.by_flow =
      area_ * prepared_.dt *
      (std::abs(flux) * liquid_.specific_heat * (inlet - heat.outlet) + 0.5 * (conducted1 + conducted2));
  return true;
}

PackedBed::StepHeat PackedBed::step(double mass_flow, double inlet) {
  // The matrix of the implicit scheme belongs to one flow.
  const double flux = mass_flow / area_;
  const bool other_inlet = conducting_inlet_ && ((flux > 0) != (prepared_.mass_flow > 0) ||
                                                 (flux < 0) != (prepared_.mass_flow < 0));
  if ((advection_ == Advection::implicit && mass_flow != prepared_.mass_flow) || other_inlet)
    prepare(prepared_.dt, mass_flow);
  StepHeat heat;
  if (advection_ != Advection::tvd) {
    heat = first_order_step(main_, flux, inlet, false);
  } else if (!second_order_step(flux, inlet, heat)) {
    if (!fallback_is_built_) build(fallback_, prepared_.dt);
    fallback_is_built_ = true;
    ++fallbacks_;
    heat = first_order_step(fallback_, flux, inlet, true);
  }
  double source = 0;
  for (const double s : source_) source += s;
  heat.by_source = area_ * prepared_.dt * source;
  return heat;
}

// Capsules that melt: Newton's method on the heat of each shell [swaminathan1993]. With h_m, T_m of the last pass
// and c = dh/dT there,
//   (h_m + c (T - T_m) - h^n)/tau = what flows in at T
// is linear. h_m + c (T - T_m) is then exactly what flowed in, whatever the number of passes, and T_{m+1} the
// temperature that belongs to it.

/// Apparent capacity and right-hand side of each shell at its temperature of the last pass [J/(m^3 K)],
/// [J/m^3].
void PackedBed::linearise_melting(const BedGrid::Run& run, const PhaseChange& phase) {
  const int n = grid_.size();
  const double share = (1 - run.layer.porosity) / shells_;
  for (int j = 0; j < shells_; ++j)
    for (int i = run.first; i < run.first + run.count; ++i) {
      const std::size_t k = std::size_t(j) * n + i;
      const double c = phase.capacity(shell_[k]);
      melt_.capacity[k] = share * c;
      melt_.right[k] = share * (c * shell_[k] - phase.heat(shell_[k]) + phase.heat(shell1_[k]));
    }
}

/// The elimination of GrainElimination with a capacity of each shell of each cell; adds to the fluid's rows.
void PackedBed::eliminate_melting(const Operator& op, const BedGrid::Run& run, const Grains& grains,
                                  const double* extra) {
  const int n = grid_.size();
  for (int i = run.first; i < run.first + run.count; ++i) {
    double rest_inside = 1, inside = 0;  // 1 - beta and alpha of the shell further in
    for (int j = shells_ - 1; j >= 1; --j) {
      const std::size_t k = std::size_t(j) * n + i;
      const double outward = grains.between[j - 1], inward = j + 1 < shells_ ? grains.between[j] : 0;
      const double held = melt_.capacity[k] / op.tau + inward * rest_inside, diagonal = held + outward;
      melt_.alpha[k] = inside = (melt_.right[k] / op.tau + inward * inside) / diagonal;
      melt_.beta[k] = outward / diagonal;
      rest_inside = held / diagonal;
    }
    const double between = shells_ > 1 ? grains.between[0] : 0;
    const double own = melt_.capacity[i] / op.tau + between * rest_inside;
    const double g = grains.exchange(film_[i]), dz = grid_.dz[i];
    melt_.alpha[i] = (melt_.right[i] / op.tau + between * inside) / (own + g);
    melt_.beta[i] = g / (own + g);
    melt_.diagonal[i] = diagonal_[i] - op.own_part[i] + own * melt_.beta[i] * dz;
    fluid_[i] = op.rate[i] * fluid_[i] + extra[i] + g * dz * melt_.alpha[i];
  }
}

/// Temperatures that belong to the heat that each shell got; by how much the linear ones were off at most
/// [K].
double PackedBed::settle_melting(const BedGrid::Run& run, const PhaseChange& phase) {
  const int n = grid_.size();
  const double share = (1 - run.layer.porosity) / shells_;
  double worst = 0;
  for (int i = run.first; i < run.first + run.count; ++i) {
    double outside = fluid_[i];
    for (int j = 0; j < shells_; ++j) {
      const std::size_t k = std::size_t(j) * n + i;
      outside = melt_.alpha[k] + melt_.beta[k] * outside;
      // capacity T - right = h - h^n, per volume of the bed
      const double heat = phase.heat(shell1_[k]) + (melt_.capacity[k] * outside - melt_.right[k]) / share;
      shell_[k] = phase.temperature(heat);
      worst = std::max(worst, std::abs(shell_[k] - outside));
    }
  }
  return worst;
}

void PackedBed::solve_with_melting(const Operator& op, const double* extra) {
  constexpr int most_passes = 30;
  constexpr double close = 1e-6;  // [K]
  fluid1_ = fluid_, shell1_ = shell_;
  for (int pass = 0; pass < most_passes; ++pass) {
    fluid_ = fluid1_;
    melt_.diagonal = diagonal_;
    for (std::size_t r = 0; r < grid_.runs.size(); ++r) {
      const BedGrid::Run& run = grid_.runs[r];
      if (!melting_[r]) {
        gather_grains(op.grains[r], cells_of(op, run), shell1_.data(), extra, fluid_.data(), sums_.data());
        continue;
      }
      linearise_melting(run, *melting_[r]);
      eliminate_melting(op, run, grains_[r], extra);
    }
    melt_.matrix.resize(grid_.size());
    melt_.matrix.factorise(lower_.data(), melt_.diagonal.data(), upper_.data());
    melt_.matrix.solve(fluid_.data());
    double worst = 0;
    for (std::size_t r = 0; r < grid_.runs.size(); ++r) {
      const BedGrid::Run& run = grid_.runs[r];
      if (melting_[r])
        worst = std::max(worst, settle_melting(run, *melting_[r]));
      else
        scatter_grains(op.grains[r], cells_of(op, run), shell1_.data(), fluid_.data(), shell_.data(),
                       sums_.data());
    }
    if (worst <= close) return;
  }
  ++fallbacks_;  // the books are right all the same
}

}  // namespace couplet::thermocline
