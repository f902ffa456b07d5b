// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "common/elasticity/finite/finite_law.hpp"

namespace couplet::elastic::finite {

/// The energy of the elastic part of F = F_e theta, theta a stretch equal in all directions (thermal), per volume before it:
///   W = theta^3 W_e(I1 / theta^2, I2 / theta^4, J / theta^3)
/// with its derivatives by the invariants of F, so that stress and tangent need not know of theta. `at`: those of F, spoilt;
/// `stretch`: theta of each place, empty: 1.
inline void evaluate(const FiniteLaw& law, std::span<Invariants> at, std::span<const Four> stretch,
                     bool with_bulk, std::span<Energy> energy) {
  for (std::size_t i = 0; i < stretch.size(); ++i) {
    const Four r = 1.0 / stretch[i], r2 = r * r;
    at[i].i1 *= r2;
    at[i].i2 *= r2 * r2;
    at[i].j *= r2 * r;
  }
  law.evaluate(at, with_bulk, energy);
  for (std::size_t i = 0; i < stretch.size(); ++i) {
    Energy& e = energy[i];
    const Four s = stretch[i], r = 1.0 / s, r2 = r * r, r3 = r2 * r;
    e.w *= s * s * s;
    e.w1 *= s;
    e.w2 *= r;
    e.w11 *= r;
    e.w12 *= r3;
    e.w1j *= r2;
    e.w22 *= r3 * r2;
    e.w2j *= r2 * r2;
    e.wjj *= r3;
  }
}

}  // namespace couplet::elastic::finite
