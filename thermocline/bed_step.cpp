// SPDX-License-Identifier: Apache-2.0
// The time step of the packed bed.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "thermocline/packed_bed.hpp"

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

void PackedBed::solve(const Operator& op, double* fluid, double* shells, const double* extra) const {
  const std::size_t n = grid_.size();
  const double* dz = grid_.dz.data();
  for (const BedGrid::Run& run : grid_.runs) {
    const GrainElimination& e = op.grains[&run - grid_.runs.data()];
    const std::size_t first = run.first, last = run.first + run.count;
    // Inside to surface: alpha_j in place of theta_j^n.
    for (int j = shells_ - 1; j >= 1; --j) {
      double* theta = shells + j * n;
      const double keep = e.keep[j], pass = e.pass[j];
      if (j == shells_ - 1)
        for (std::size_t i = first; i < last; ++i) theta[i] *= keep;
      else
        for (std::size_t i = first; i < last; ++i) theta[i] = keep * theta[i] + pass * theta[i + n];
    }
    const double store = e.store, inner = e.inner;
    const std::size_t inside = shells_ > 1 ? n : 0;
    for (std::size_t i = first; i < last; ++i) {
      shells[i] = (store * shells[i] + inner * shells[i + inside]) * dz[i] * op.surface[i];
      fluid[i] = op.rate[i] * fluid[i] + extra[i] + op.exchange[i] * shells[i];
    }
  }
  op.matrix.solve(fluid);
  for (const BedGrid::Run& run : grid_.runs) {
    const GrainElimination& e = op.grains[&run - grid_.runs.data()];
    const std::size_t first = run.first, last = run.first + run.count;
    for (std::size_t i = first; i < last; ++i) shells[i] += op.exchange[i] * op.surface[i] * fluid[i];
    for (int j = 1; j < shells_; ++j) {
      double* theta = shells + j * n;
      const double beta = e.beta[j];
      for (std::size_t i = first; i < last; ++i) theta[i] += beta * theta[i - n];
    }
  }
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
  double* face = face_.data();
  // Temperature that crosses face i (below cell i), from the side where the flow comes from.
  if (up) {
    for (int i = 1; i <= n; ++i) face[i] = t[i - 1];
    if (second_order) {
      for (int i = 2; i < n; ++i) face[i] += half_slope(t[i - 1] - t[i - 2], t[i] - t[i - 1]);
      if (n > 1) face[1] += half_slope(2 * (t[0] - inlet), t[1] - t[0]);
    }
    face[0] = inlet;
  } else {
    for (int i = 0; i < n; ++i) face[i] = t[i];
    if (second_order) {
      for (int i = 1; i < n - 1; ++i) face[i] += half_slope(t[i] - t[i + 1], t[i - 1] - t[i]);
      if (n > 1) face[n - 1] += half_slope(2 * (t[n - 1] - inlet), t[n - 2] - t[n - 1]);
    }
    face[n] = inlet;
  }
  const double gc = flux * liquid_.specific_heat;
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
  solve(op, fluid_.data(), shell_.data(), extra_.data());
  if (advection_ == Advection::implicit && flux != 0) stage.outlet = fluid_[exit];
  stage.conducted = through_inlet * (inlet - fluid_[entry]);
  StepHeat heat;
  heat.outlet = stage.outlet;
  heat.by_flow =
      area_ * dt_ * (std::abs(flux) * liquid_.specific_heat * (inlet - stage.outlet) + stage.conducted);
  return heat;
}

void PackedBed::keep_state() {
  std::copy(fluid_.begin(), fluid_.end(), fluid0_.begin());
  std::copy(shell_.begin(), shell_.end(), shell0_.begin());
}

void PackedBed::take_back() {
  std::copy(fluid0_.begin(), fluid0_.end(), fluid_.begin());
  std::copy(shell0_.begin(), shell0_.end(), shell_.begin());
}

/// IMEX-SSP2(2,2,2) of Pareschi and Russo (2005): Heun's strong-stability-preserving method for advection, an
/// L-stable SDIRK with gamma = 1 - 1/sqrt(2) for conduction and exchange, second order together:
///   U1 = u + gamma dt L U1
///   U2 = u + dt A(U1) + dt (1 - 2 gamma) L U1 + gamma dt L U2
///   u' = u + dt/2 (A(U1) + A(U2)) + dt/2 (L U1 + L U2)
/// False if the result leaves the range of what went in, which second order cannot exclude for exchange much
/// faster than the step; the state is then as before.
bool PackedBed::second_order_step(double flux, double inlet, StepHeat& heat) {
  const std::size_t n = fluid_.size(), ns = shell_.size();
  const double gamma = main_.tau / dt_, carry = (1 - 2 * gamma) / gamma;
  const double through_inlet = flux != 0 ? inlet_conductance(flux > 0) : 0;
  const std::size_t entry = flux > 0 ? 0 : n - 1;
  keep_state();
  // U1 in fluid_, shell_. What enters by conduction counts as part of L.
  std::fill(extra_.begin(), extra_.end(), 0.0);
  extra_[entry] = through_inlet * inlet;
  solve(main_, fluid_.data(), shell_.data(), extra_.data());
  const double conducted1 = through_inlet * (inlet - fluid_[entry]);
  const Stage first = explicit_terms(fluid_.data(), flux, inlet, true);
  std::swap(extra_, extra2_);  // A(U1) in extra2_
  // fluid1_, shell1_: the right-hand side of U2; kept in fluid0_, shell0_: u + dt/2 (A1 + L U1) so far.
  for (std::size_t i = 0; i < n; ++i) {
    const double l = fluid_[i] - fluid0_[i], a = dt_ / capacity_[i] * extra2_[i];
    fluid1_[i] = fluid0_[i] + a + carry * l;
    fluid_[i] = fluid0_[i] + 0.5 * a + 0.5 / gamma * l;
  }
  for (std::size_t i = 0; i < ns; ++i) {
    const double l = shell_[i] - shell0_[i];
    shell1_[i] = shell0_[i] + carry * l;
    shell_[i] = shell0_[i] + 0.5 / gamma * l;
  }
  // Half of U2's share is now in fluid_, shell_; its right-hand side is subtracted before it is overwritten.
  for (std::size_t i = 0; i < n; ++i) fluid_[i] -= 0.5 / gamma * fluid1_[i];
  for (std::size_t i = 0; i < ns; ++i) shell_[i] -= 0.5 / gamma * shell1_[i];
  std::fill(extra_.begin(), extra_.end(), 0.0);
  extra_[entry] = through_inlet * inlet;
  solve(main_, fluid1_.data(), shell1_.data(), extra_.data());
  const double conducted2 = through_inlet * (inlet - fluid1_[entry]);
  const Stage second = explicit_terms(fluid1_.data(), flux, inlet, true);
  for (std::size_t i = 0; i < n; ++i)
    fluid_[i] += 0.5 / gamma * fluid1_[i] + 0.5 * dt_ / capacity_[i] * extra_[i];
  for (std::size_t i = 0; i < ns; ++i) shell_[i] += 0.5 / gamma * shell1_[i];
  heat.outlet = 0.5 * (first.outlet + second.outlet);
  heat.by_flow =
      area_ * dt_ *
      (std::abs(flux) * liquid_.specific_heat * (inlet - heat.outlet) + 0.5 * (conducted1 + conducted2));
  Range before{flux != 0 ? inlet : fluid0_[0], flux != 0 ? inlet : fluid0_[0]};
  before.add(fluid0_.data(), n);
  before.add(shell0_.data(), ns);
  Range after = before;
  after.add(fluid_.data(), n);
  after.add(shell_.data(), ns);
  const double slack = 1e-9 * (before.high - before.low) + 1e-11 * before.high + source_rate_ * dt_;
  if (after.low >= before.low - slack && after.high <= before.high + slack) return true;
  take_back();
  return false;
}

PackedBed::StepHeat PackedBed::step(double mass_flow, double inlet) {
  // The matrix of the implicit scheme belongs to one flow.
  const double flux = mass_flow / area_;
  const bool other_inlet =
      conducting_inlet_ && ((flux > 0) != (prepared_flow_ > 0) || (flux < 0) != (prepared_flow_ < 0));
  if ((advection_ == Advection::implicit && mass_flow != prepared_flow_) || other_inlet)
    prepare(dt_, mass_flow);
  StepHeat heat;
  if (advection_ != Advection::tvd) {
    heat = first_order_step(main_, flux, inlet, false);
  } else if (!second_order_step(flux, inlet, heat)) {
    if (!fallback_is_built_) build(fallback_, dt_);
    fallback_is_built_ = true;
    ++fallbacks_;
    heat = first_order_step(fallback_, flux, inlet, true);
  }
  double source = 0;
  for (const double s : source_) source += s;
  heat.by_source = area_ * dt_ * source;
  return heat;
}

}  // namespace couplet::thermocline
