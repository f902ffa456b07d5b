// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "common/elasticity/elasticity.hpp"
#include "common/elasticity/lanes.hpp"

namespace couplet::elastic {

/// Of C = F^T F: I1 = tr C, I2 = (I1^2 - tr C^2) / 2, and J = det F.
struct Invariants {
  Four i1, i2, j;
};

/// An energy W(I1, I2, J) [Pa] with its first and second derivatives.
template <class T>
struct EnergyOf {
  T w{}, w1{}, w2{}, wj{}, w11{}, w12{}, w1j{}, w22{}, w2j{}, wjj{};
};
using Energy = EnergyOf<Four>;

/// U(J) with its first two derivatives [Pa].
template <class T>
struct BulkOf {
  T u{}, pressure{}, modulus{};
};

/// A hyperelastic isotropic law: the energy of a unit of undeformed volume by the invariants of the
/// deformation. What is made of it (stress, tangent) stands in finite_strain.hpp, so that a law is its
/// derivatives and no more.
class FiniteLaw {
 public:
  virtual ~FiniteLaw() = default;
  /// One call a chunk of places: W whole, or without its bulk part U(J).
  virtual void evaluate(std::span<const Invariants> at, bool with_bulk, std::span<Energy> energy) const = 0;
  /// The part that depends on J alone and grows without bound as nu goes to 1/2.
  virtual BulkOf<double> bulk(double j) const = 0;
  /// Some laws have none (Saint Venant-Kirchhoff: its pressure is not one of the volume).
  virtual bool has_bulk() const = 0;
  /// I2 appears in W.
  virtual bool has_second_invariant() const = 0;
};

}  // namespace couplet::elastic

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
