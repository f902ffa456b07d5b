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
void balance(StrainState& state) {
  const Tensor4& f = state.f;
  const Four square = f[0][0] * f[0][0] + f[0][1] * f[0][1] + f[1][0] * f[1][0] + f[1][1] * f[1][1];
  const Four area = f[0][0] * f[1][1] - f[0][1] * f[1][0];
  state.wj = -2.0 * f[2][2] * (state.w1 + square * state.w2) / area;
}

}  // namespace

/// Sets `thinning` to -d ln l / d ln (in-plane area) of the linear sheet.
void Places::set_plane_stress() {
  sheet.resize(states.size());
  StrainState state{};
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

Sheet sheet_of(const StrainState& state) {
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

namespace couplet::elastic {
namespace {

/// Gathers the tensors of four edges as components.
void gather(const double* values, const std::array<Index, 4>& at, bool is_change, Four (&t)[3][3]) {
  for (int a = 0; a < 3; ++a)
    for (int b = 0; b < 3; ++b)
      for (int k = 0; k < 4; ++k)
        t[a][b][k] = values[std::size_t(at[k]) * SharedEdges::gradient_stride + std::size_t(a * 3 + b)] +
                     (a == b && !is_change ? 1 : 0);
}

void scatter(const Four (&t)[3][3], const std::array<Index, 4>& at, double* values) {
  for (int a = 0; a < 3; ++a)
    for (int b = 0; b < 3; ++b)
      for (int k = 0; k < 4; ++k)
        values[std::size_t(at[k]) * SharedEdges::gradient_stride + std::size_t(a * 3 + b)] = t[a][b][k];
}

}  // namespace

FiniteEdges::FiniteEdges(const mesh::Mesh& mesh, const ElasticOperator& rows, const SharedFaces& shared,
                         std::span<const FiniteLaw> laws)
    : edges_(mesh, rows, shared), value_(edges_.n_edges() * SharedEdges::gradient_stride, 0), kept_(value_) {
  std::vector<int> material(edges_.n_edges(), 0);
  if (laws.size() > 1)
    for (std::size_t i = 0; i < shared.faces.size(); ++i)
      for (const Index e : edges_.edges_of(i)) material[e] = mesh.material_of(mesh.owner[shared.faces[i]]);
  for (std::size_t m = 0; m < laws.size(); ++m) {
    EdgeGroup group;
    group.law = &laws[m];
    Index last = -1;  // padding uses the last edge of the block
    std::size_t n = 0;
    const auto add = [&](Index e, double of_edge) {
      if (n % 4 == 0) group.edges.emplace_back(), group.volume.emplace_back();
      group.edges.back()[n % 4] = e;
      group.volume.back()[n % 4] = of_edge;
      ++n;
    };
    for (Index e = 0; e < Index(material.size()); ++e) {
      if (material[e] != int(m)) continue;
      last = e;
      add(e, edges_.is_owned(e) ? edges_.volume(e) : 0);
    }
    while (n % 4 != 0) add(last, 0);
    group.states.resize(group.edges.size());
    groups_.push_back(std::move(group));
  }
}

void FiniteEdges::take_stretch() {
  for (EdgeGroup& group : groups_) {
    group.stretch.resize(group.edges.size());
    for (std::size_t i = 0; i < group.edges.size(); ++i)
      for (int k = 0; k < 4; ++k) group.stretch[i][k] = 1 + at(group.edges[i][std::size_t(k)])[0];
  }
}

void FiniteEdges::forget_stretch() {
  for (EdgeGroup& group : groups_) group.stretch.clear();
}

double FiniteEdges::to_stress(bool with_bulk, double& energy) {
  double least = 1;
  std::ranges::copy(value_, kept_.begin());
  for (EdgeGroup& group : groups_)
    for (std::size_t i = 0; i < group.edges.size(); ++i) {
      finite::StrainState& state = group.states[i];
      gather(kept_.data(), group.edges[i], false, state.f);
      Invariants at = finite::invariants(state.f);
      for (int k = 0; k < 4; ++k)
        if (!(at.j[k] >= least)) least = at.j[k];
      if (!(least > 0)) return least;
      Energy e;
      group.evaluate(i, {&at, 1}, with_bulk, {&e, 1});
      for (int k = 0; k < 4; ++k) energy += group.volume[i][k] * e.w[k];
      Four p[3][3];
      group.law->has_second_invariant ? finite::stress<true>(state, p) : finite::stress<false>(state, p);
      scatter(p, group.edges[i], value_.data());
    }
  return least;
}

void FiniteEdges::set_start(bool with_bulk) {
  for (EdgeGroup& group : groups_) group.set_start(with_bulk);
}

void FiniteEdges::to_conserving(bool with_bulk) {
  for (const EdgeGroup& group : groups_)
    for (std::size_t i = 0; i < group.edges.size(); ++i) {
      Four p[3][3];
      finite::conserving_stress(*group.law, group.states[i].f, group.start[i].f, group.start[i].energy,
                                with_bulk, Four{}, p);
      scatter(p, group.edges[i], value_.data());
    }
}

void FiniteEdges::to_tangent() {
  for (const EdgeGroup& group : groups_)
    for (std::size_t i = 0; i < group.edges.size(); ++i) {
      Four df[3][3], dp[3][3];
      gather(value_.data(), group.edges[i], true, df);
      group.law->has_second_invariant ? finite::tangent<true>(group.states[i], df, Four{}, dp)
                                      : finite::tangent<false>(group.states[i], df, Four{}, dp);
      scatter(dp, group.edges[i], value_.data());
    }
}

}  // namespace couplet::elastic
