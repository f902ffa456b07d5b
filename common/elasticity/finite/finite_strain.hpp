// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>

#include "common/elasticity/finite/finite_law.hpp"

/// First Piola-Kirchhoff stress P = dW/dF and its directional derivative for an energy of the invariants
/// [holzapfel2000], four locations at a time:
///   P  = 2 W1 F + 2 W2 B + WJ H,   B = I1 F - F C,   H = dJ/dF (the cofactors of F)
///   dP = 2 W1 dF + 2 dW1 F + 2 W2 dB + 2 dW2 B + WJ dH + dWJ H
/// with dW1 = W11 dI1 + W12 dI2 + W1J dJ and so on, dI1 = 2 F:dF, dI2 = 2 B:dF, dJ = H:dF.
namespace couplet::elastic::finite {

using Tensor4 = Four[3][3];

/// State at which the derivative is evaluated.
struct alignas(32) StrainState {
  Four f[3][3];
  Four w1, w2, wj, w11, w12, w1j, w22, w2j, wjj;
};

[[gnu::always_inline]] inline void cofactors(const Tensor4& f, Tensor4& h) {
  for (int i = 0; i < 3; ++i) {
    const int i1 = (i + 1) % 3, i2 = (i + 2) % 3;
    for (int j = 0; j < 3; ++j) {
      const int j1 = (j + 1) % 3, j2 = (j + 2) % 3;
      h[i][j] = f[i1][j1] * f[i2][j2] - f[i1][j2] * f[i2][j1];
    }
  }
}

[[gnu::always_inline]] inline Four product(const Tensor4& a, const Tensor4& b) {
  Four sum = a[0][0] * b[0][0];
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      if (i + j > 0) sum += a[i][j] * b[i][j];
  return sum;
}

/// C = F^T F.
[[gnu::always_inline]] inline void right_cauchy_green(const Tensor4& f, Tensor4& c) {
  for (int i = 0; i < 3; ++i)
    for (int j = i; j < 3; ++j) {
      c[i][j] = f[0][i] * f[0][j] + f[1][i] * f[1][j] + f[2][i] * f[2][j];
      c[j][i] = c[i][j];
    }
}

[[gnu::always_inline]] inline Invariants invariants(const Tensor4& f) {
  Invariants at;
  Tensor4 h;
  cofactors(f, h);
  at.j = f[0][0] * h[0][0] + f[0][1] * h[0][1] + f[0][2] * h[0][2];
  at.i1 = product(f, f);
  at.i2 = product(h, h);  // tr cof C
  return at;
}

/// B = I1 F - F C.
[[gnu::always_inline]] inline void second(const Tensor4& f, const Four& i1, Tensor4& b) {
  Tensor4 c;
  right_cauchy_green(f, c);
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      b[i][j] = i1 * f[i][j] - (f[i][0] * c[0][j] + f[i][1] * c[1][j] + f[i][2] * c[2][j]);
}

template <bool HasSecond>
[[gnu::always_inline]] inline void stress(const StrainState& s, Tensor4& p) {
  Tensor4 h, b;
  cofactors(s.f, h);
  if constexpr (HasSecond) second(s.f, product(s.f, s.f), b);
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) {
      p[i][j] = 2.0 * s.w1 * s.f[i][j] + s.wj * h[i][j];
      if constexpr (HasSecond) p[i][j] += 2.0 * s.w2 * b[i][j];
    }
}

/// dB = dI1 F + I1 dF - dF C - F (dF^T F + F^T dF).
[[gnu::always_inline]] inline void second_change(const StrainState& s, const Tensor4& df, const Four& i1,
                                                 const Four& di1, Tensor4& db) {
  Tensor4 c, dc;
  right_cauchy_green(s.f, c);
  for (int i = 0; i < 3; ++i)
    for (int j = i; j < 3; ++j) {
      dc[i][j] = df[0][i] * s.f[0][j] + s.f[0][i] * df[0][j];
      for (int k = 1; k < 3; ++k) dc[i][j] += df[k][i] * s.f[k][j] + s.f[k][i] * df[k][j];
      dc[j][i] = dc[i][j];
    }
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) {
      db[i][j] = di1 * s.f[i][j] + i1 * df[i][j];
      for (int k = 0; k < 3; ++k) db[i][j] -= df[i][k] * c[k][j] + s.f[i][k] * dc[k][j];
    }
}

/// Directional derivative dP. `dpressure` is the change of a separate pressure, whose value is included in
/// s.wj.
template <bool HasSecond>
[[gnu::always_inline]] inline void tangent(const StrainState& s, const Tensor4& df, const Four& dpressure,
                                           Tensor4& dp) {
  Tensor4 h, b, db;
  cofactors(s.f, h);
  const Four di1 = 2.0 * product(s.f, df), dj = product(h, df);
  Four a1 = s.w11 * di1 + s.w1j * dj, aj = s.w1j * di1 + s.wjj * dj + dpressure;
  Four a2{};
  if constexpr (HasSecond) {
    const Four i1 = product(s.f, s.f);
    second(s.f, i1, b);
    const Four di2 = 2.0 * product(b, df);
    a1 += s.w12 * di2;
    aj += s.w2j * di2;
    a2 = s.w12 * di1 + s.w22 * di2 + s.w2j * dj;
    second_change(s, df, i1, di1, db);
  }
  for (int i = 0; i < 3; ++i) {
    const int i1 = (i + 1) % 3, i2 = (i + 2) % 3;
    for (int j = 0; j < 3; ++j) {
      const int j1 = (j + 1) % 3, j2 = (j + 2) % 3;
      const Four dh = df[i1][j1] * s.f[i2][j2] + s.f[i1][j1] * df[i2][j2] - df[i1][j2] * s.f[i2][j1] -
                      s.f[i1][j2] * df[i2][j1];
      dp[i][j] = 2.0 * (s.w1 * df[i][j] + a1 * s.f[i][j]) + s.wj * dh + aj * h[i][j];
      if constexpr (HasSecond) dp[i][j] += 2.0 * (s.w2 * db[i][j] + a2 * b[i][j]);
    }
  }
}

[[gnu::always_inline]] inline void keep(const Energy& e, StrainState& s) {
  s.w1 = e.w1, s.w2 = e.w2, s.wj = e.wj;
  s.w11 = e.w11, s.w12 = e.w12, s.w1j = e.w1j, s.w22 = e.w22, s.w2j = e.w2j, s.wjj = e.wjj;
}

/// F and W at the start of an energy-conserving step.
struct alignas(32) Start {
  Four f[3][3];
  Four energy;
};

/// Size of D below which the quotient is dominated by round-off; its correction is then negligible.
constexpr double smallest_change = 1e-4;

/// Derivative of an energy of the invariants with respect to C: w1 I + w2 (i1 I - C) + wj J/2 C^-1.
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

/// D / (D:D) times `gap`. Zero if D is negligible or the gap is round-off of `size`.
inline Four quotient(const Four& gap, const Four& square, const Four& size) {
  Four q{};
  for (int k = 0; k < 4; ++k)
    if (square[k] > smallest_change * smallest_change && std::abs(gap[k]) > 1e-14 * size[k])
      q[k] = gap[k] / square[k];
  return q;
}

/// Stress of a step from F_0 to F_1 = 2 F - F_0 (midpoint F) whose work is exactly W(C_1) - W(C_0)
/// [gonzalez2000]. With C = (C_0 + C_1) / 2 and D = C_1 - C_0:
///   S* = 2 W'(C) + 2 [W(C_1) - W(C_0) - W'(C):D] D / (D:D),   P* = F S*
/// S* is symmetric, so linear and angular momentum are conserved. A pressure of the volume ratio (one per
/// cell) uses the same difference quotient of J. `start` is F_0, `energy_start` is W there, and `pressure` is
/// that of the cells if the law is evaluated without its bulk part.
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
