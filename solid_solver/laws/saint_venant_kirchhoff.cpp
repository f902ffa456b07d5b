// SPDX-License-Identifier: Apache-2.0
#include "solid_solver/laws/laws.hpp"

namespace couplet::laws {
namespace {

/// Hooke's law for Green's strain E = (C - I)/2, thesis (2.29): W = lambda/2 (tr E)^2 + mu E:E. For large
/// rotations and small strains: it softens in compression and has no stiffness at J = 0.58.
struct SaintVenantKirchhoff {
  static constexpr bool has_bulk = false, has_second_invariant = true;
  double mu, lambda;

  template <class T>
  elastic::EnergyOf<T> shape(const T& I1, const T& I2, const T&) const {
    const T twice = I1 - 3.0;  // 2 tr E; 4 E:E = I1^2 - 2 I2 - 2 I1 + 3
    elastic::EnergyOf<T> e;
    e.w = lambda / 8 * twice * twice + mu / 4 * (I1 * I1 - 2.0 * I2 - 2.0 * I1 + 3.0);
    e.w1 = lambda / 4 * twice + mu / 2 * (I1 - 1.0);
    e.w2 = -mu / 2 + 0.0 * I1;
    e.w11 = lambda / 4 + mu / 2 + 0.0 * I1;
    return e;
  }
  template <class T>
  elastic::BulkOf<T> bulk(const T&) const {
    return {};
  }
};

}  // namespace

elastic::FiniteLaw saint_venant_kirchhoff(const elastic::LameConstants& lame, std::span<const double>) {
  return finite_law(SaintVenantKirchhoff{lame.mu, lame.lambda});
}

}  // namespace couplet::laws
