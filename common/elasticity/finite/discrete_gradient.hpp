// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>

#include "common/elasticity/finite/finite_strain.hpp"

/// The stress of a step from F_0 to F_1 = 2 F - F_0 (F in the middle) that does exactly the work W(C_1) - W(C_0)
/// [gonzalez2000]: with C = (C_0 + C_1) / 2 and D = C_1 - C_0
///   S* = 2 W'(C) + 2 [W(C_1) - W(C_0) - W'(C):D] D / (D:D),   P* = F S*,
/// S* symmetric, so that neither linear nor angular momentum changes. A pressure of the volume ratio (one a cell) goes
/// with the same difference quotient of J.
namespace couplet::elastic::finite {

/// Where such a step began: F and W.
struct alignas(32) Start {
  Four f[3][3];
  Four energy;
};

/// Below this size of D the quotient is rounding, and what it would correct is smaller still.
constexpr double smallest_change = 1e-4;

/// dX/dC of an energy by invariants: w1 I + w2 (i1 I - C) + wj J/2 C^-1.
inline void by_c(const Tensor4& c, const Four& w1, const Four& w2, const Four& wj, const Four& j,
                 Tensor4& to) {
  Tensor4 h;
  cofactors(c, h);
  const Four i1 = c[0][0] + c[1][1] + c[2][2];
  for (int a = 0; a < 3; ++a)
    for (int b = 0; b < 3; ++b) {
      to[a][b] = 0.5 * wj / j * h[a][b] - w2 * c[a][b];
      if (a == b) to[a][b] += w1 + w2 * i1;
    }
}

inline Invariants invariants_of_c(const Tensor4& c) {
  Tensor4 h;
  cofactors(c, h);
  Invariants at;
  at.i1 = c[0][0] + c[1][1] + c[2][2];
  at.i2 = h[0][0] + h[1][1] + h[2][2];
  const Four square = c[0][0] * h[0][0] + c[0][1] * h[0][1] + c[0][2] * h[0][2];
  for (int k = 0; k < 4; ++k) at.j[k] = square[k] > 0 ? std::sqrt(square[k]) : 1e-300;
  return at;
}

/// D / (D:D) times `gap`; nothing where D is all but nothing or the gap is rounding of `size`.
inline Four quotient(const Four& gap, const Four& square, const Four& size) {
  Four q{};
  for (int k = 0; k < 4; ++k)
    if (square[k] > smallest_change * smallest_change && std::abs(gap[k]) > 1e-14 * size[k])
      q[k] = gap[k] / square[k];
  return q;
}

/// `start`: F_0; `energy_start`: W there; `pressure`: of the cells, where the law is asked without its bulk part.
inline void conserving_stress(const FiniteLaw& law, const Tensor4& middle, const Tensor4& start,
                              const Four& energy_start, bool with_bulk, const Four& pressure, Tensor4& p) {
  Tensor4 end, c0, c1, c, a, b;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) end[i][j] = 2.0 * middle[i][j] - start[i][j];
  right_cauchy_green(start, c0);
  right_cauchy_green(end, c1);
  Tensor4 d;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) {
      c[i][j] = 0.5 * (c0[i][j] + c1[i][j]);
      d[i][j] = c1[i][j] - c0[i][j];
    }
  const Invariants at[2] = {invariants_of_c(c), invariants(end)};
  Energy e[2];
  law.evaluate(at, with_bulk, e);
  by_c(c, e[0].w1, e[0].w2, e[0].wj, at[0].j, a);
  by_c(c, Four{}, Four{}, Four{} + 1.0, at[0].j, b);
  const Four square = product(d, d);
  const Four energy_size = 4.0 * e[0].w1 + e[1].w + energy_start;
  Four size, one = Four{} + 1.0;
  for (int k = 0; k < 4; ++k) size[k] = std::abs(energy_size[k]);
  const Four beta = quotient(e[1].w - energy_start - product(a, d), square, size);
  const Four gamma = quotient(at[1].j - invariants(start).j - product(b, d), square, one);
  Tensor4 s;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      s[i][j] = 2.0 * (a[i][j] + beta * d[i][j] + pressure * (b[i][j] + gamma * d[i][j]));
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      p[i][j] = middle[i][0] * s[0][j] + middle[i][1] * s[1][j] + middle[i][2] * s[2][j];
}

}  // namespace couplet::elastic::finite
