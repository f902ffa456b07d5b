// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "common/elasticity/finite/finite_strain.hpp"

/// Plane stress: the stretch l = F_33 across the sheet is the one that leaves P_33 = dW/dl = 0, found at each place by itself.
/// In-plane forces are then those of W(F, l(F)), P of the whole F, and their derivative is condensed:
///   dP = dP|_l - D (D : dF) / c,   D = dP_33/dF = dP/dl,   c = dP_33/dl.
namespace couplet::elastic::finite {

/// What the condensed derivative needs of four places.
struct alignas(32) Sheet {
  Four d[2][2];
  Four c;
};

/// Below this stretch a place counts as inside out: there is no l > 0 without stress.
constexpr double thinnest = 1e-3;

/// Poisson's ratio over 1 - itself at rest: -d ln l / d ln (in-plane area) of the linear sheet.
double thinning(const FiniteLaw& law);

/// `at`: invariants of F with F_33 = 1 on entry, of F with l at the end (J = 0: there is none); `states`: F alone; the
/// first guess follows from F, so that the answer does not depend on what was before.
void relax(const FiniteLaw& law, double thinning, std::span<const Four> stretch, std::span<Invariants> at,
           State* states);

/// Of a state whose l and derivatives of W are known.
Sheet sheet_of(const State& state);

/// In-plane dP of a change without l to that with it.
[[gnu::always_inline]] inline void condense(const Sheet& sheet, const Tensor4& df, Tensor4& dp) {
  const Four along = (sheet.d[0][0] * df[0][0] + sheet.d[0][1] * df[0][1] + sheet.d[1][0] * df[1][0] +
                      sheet.d[1][1] * df[1][1]) /
                     sheet.c;
  for (int a = 0; a < 2; ++a)
    for (int b = 0; b < 2; ++b) dp[a][b] -= sheet.d[a][b] * along;
}

}  // namespace couplet::elastic::finite
