// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <span>

#include "common/elasticity/elasticity.hpp"
#include "common/elasticity/lanes.hpp"

namespace couplet::elastic {

/// Invariants of C = F^T F: I1 = tr C, I2 = (I1^2 - tr C^2) / 2, and J = det F.
struct Invariants {
  Four i1, i2, j;
};

/// Energy W(I1, I2, J) [Pa] with its first and second derivatives.
template <class T>
struct EnergyOf {
  T w{}, w1{}, w2{}, wj{}, w11{}, w12{}, w1j{}, w22{}, w2j{}, wjj{};
};
using Energy = EnergyOf<Four>;

/// Volumetric energy U(J) with its first two derivatives [Pa].
template <class T>
struct BulkOf {
  T u{}, pressure{}, modulus{};
};

/// Hyperelastic isotropic law: energy per undeformed volume as a function of the invariants. Stress and
/// tangent are derived in finite_strain.hpp, so a law consists only of its derivatives.
struct FiniteLaw {
  /// Evaluates W for many states at once, with or without its bulk part U(J).
  std::function<void(std::span<const Invariants> at, bool with_bulk, std::span<Energy> energy)> evaluate;
  /// Part that depends only on J and becomes infinite as nu approaches 1/2.
  std::function<BulkOf<double>(double j)> bulk;
  bool has_bulk;              ///< false for Saint Venant-Kirchhoff, whose pressure is not a function of J
  bool has_second_invariant;  ///< true if W depends on I2
};

}  // namespace couplet::elastic

namespace couplet::elastic::finite {

/// Energy of the elastic part of F = F_e theta with an isotropic (thermal) stretch theta, per undeformed
/// volume:
///   W = theta^3 W_e(I1 / theta^2, I2 / theta^4, J / theta^3)
/// Derivatives are with respect to the invariants of F, so stress and tangent do not depend on theta. `at`
/// are these invariants and is overwritten. `stretch` is theta of each state, or empty for 1.
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
