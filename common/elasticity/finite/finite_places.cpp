// SPDX-License-Identifier: Apache-2.0
#include "common/elasticity/finite/finite_places.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

namespace couplet::elastic::finite {
namespace {

// Newton's method for the stretch. A step changes it at most by the factor `largest_step`.
constexpr int most_steps = 60;
constexpr double largest_step = 2, converged = 1e-13;

/// Invariants of F from the in-plane F : F and det F.
Invariants with(const Four& square, const Four& area, const Four& l) {
  Invariants at;
  at.i1 = square + l * l;
  at.i2 = area * area + l * l * square;
  at.j = area * l;
  return at;
}

/// Performs one Newton step from l. Returns the largest relative change.
double step(const Energy& e, const Four& square, const Four& area, Four& l) {
  const Four a1 = 2.0 * l, a2 = 2.0 * l * square;
  const Four slope = a1 * e.w1 + a2 * e.w2 + area * e.wj;
  const Four bend = 2.0 * e.w1 + 2.0 * square * e.w2 + a1 * a1 * e.w11 + a2 * a2 * e.w22 +
                    area * area * e.wjj + 2.0 * (a1 * a2 * e.w12 + a1 * area * e.w1j + a2 * area * e.w2j);
  double change = 0;
  for (int k = 0; k < 4; ++k) {
    const double newton =
        bend[k] > 0 ? l[k] - slope[k] / bend[k] : l[k] * (slope[k] > 0 ? 1 / largest_step : largest_step);
    const double next = std::clamp(newton, l[k] / largest_step, l[k] * largest_step);
    change = std::max(change, std::abs(next - l[k]) / l[k]);
    if (l[k] > thinnest) l[k] = next;  // a lost one stays unchanged
  }
  return change;
}

/// Sets dW/dJ of a sheet from P_33 = 0, without the round-off of det F times the bulk modulus.
void balance(State& state) {
  const Tensor4& f = state.f;
  const Four square = f[0][0] * f[0][0] + f[0][1] * f[0][1] + f[1][0] * f[1][0] + f[1][1] * f[1][1];
  const Four area = f[0][0] * f[1][1] - f[0][1] * f[1][0];
  state.wj = -2.0 * f[2][2] * (state.w1 + square * state.w2) / area;
}

}  // namespace

/// Sets `thinning` to -d ln l / d ln (in-plane area) of the linear sheet.
void Places::set_plane_stress() {
  sheet.resize(states.size());
  State state{};
  for (int a = 0; a < 3; ++a) state.f[a][a] = Four{} + 1.0;
  const Invariants at = invariants(state.f);
  Energy e;
  law->evaluate({&at, 1}, true, {&e, 1});
  keep(e, state);
  const Sheet linear = sheet_of(state);
  thinning = linear.d[0][0][0] / linear.c[0];
}

void Places::relax(std::size_t first, std::span<Invariants> found) {
  if (sheet.empty()) return;
  for (std::size_t i = 0; i < found.size(); ++i) {
    const Four square = found[i].i1 - 1.0, area = found[i].j;
    const std::span<const Four> theta = stretch_at(first + i, 1);
    Four l;
    bool is_sound = true;
    for (int k = 0; k < 4; ++k) {
      is_sound = is_sound && area[k] > 0;
      const double free = theta.empty() ? 1 : theta[0][k];
      l[k] = area[k] > 0 ? free * std::pow(area[k] / (free * free), -thinning) : 1;
    }
    if (!is_sound) continue;  // the step will be shortened
    double change = std::numeric_limits<double>::infinity();
    for (int n = 0; n < most_steps && change > converged; ++n) {
      Invariants here = with(square, area, l);
      Energy e;
      finite::evaluate(*law, {&here, 1}, theta, true, {&e, 1});
      change = step(e, square, area, l);
    }
    found[i] = with(square, area, l);
    for (int k = 0; k < 4; ++k)
      if (!(l[k] > thinnest) || !(change <= 1e3 * converged)) found[i].j[k] = 0;
    states[first + i].f[2][2] = l;
  }
}

void Places::evaluate(std::size_t first, std::span<Invariants> found, bool with_bulk,
                      std::span<Energy> energy) {
  finite::evaluate(*law, found, stretch_at(first, found.size()), with_bulk, energy);
  for (std::size_t i = 0; i < found.size(); ++i) {
    keep(energy[i], states[first + i]);
    if (sheet.empty()) continue;
    balance(states[first + i]);
    sheet[first + i] = sheet_of(states[first + i]);
  }
}

void Places::set_start(bool with_bulk) {
  start.resize(states.size());
  for (std::size_t i = 0; i < states.size(); ++i) {
    std::memcpy(start[i].f, states[i].f, sizeof start[i].f);
    const Invariants at = invariants(start[i].f);
    Energy energy;
    law->evaluate({&at, 1}, with_bulk, {&energy, 1});
    start[i].energy = energy.w;
  }
}

Sheet sheet_of(const State& state) {
  Four across[3][3] = {}, dp[3][3];
  across[2][2] = Four{} + 1.0;
  tangent<true>(state, across, Four{}, dp);
  Sheet sheet;
  for (int a = 0; a < 2; ++a)
    for (int b = 0; b < 2; ++b) sheet.d[a][b] = dp[a][b];
  sheet.c = dp[2][2];
  return sheet;
}

}  // namespace couplet::elastic::finite
