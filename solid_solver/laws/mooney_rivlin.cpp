// SPDX-License-Identifier: Apache-2.0
#include "solid_solver/laws/laws.hpp"

namespace couplet::laws {
namespace {

/// W = c10 (i1 - 3) + c01 (i2 - 3) + K/2 (J - 1)^2 with isochoric invariants i1, i2; small-strain shear
/// modulus 2 (c10 + c01).
struct MooneyRivlin {
  static constexpr bool has_bulk = true, has_second_invariant = true;
  double c10, c01, K;

  template <class T>
  elastic::EnergyOf<T> shape(const T& I1, const T& I2, const T& J) const {
    const Isochoric<T> iso(I1, I2, J);
    elastic::EnergyOf<T> psi;
    psi.w = c10 * (iso.i1 - 3.0) + c01 * (iso.i2 - 3.0);
    psi.w1 = c10 + 0.0 * J;
    psi.w2 = c01 + 0.0 * J;
    return iso.energy(psi);
  }
  template <class T>
  elastic::BulkOf<T> bulk(const T& J) const {
    return quadratic_bulk(K, J);
  }
};

}  // namespace

elastic::FiniteLaw mooney_rivlin(const elastic::LameConstants& lame, std::span<const double> coefficients) {
  const double share = coefficients.empty() ? 0 : coefficients[0];
  return finite_law(
      MooneyRivlin{lame.mu / 2 * (1 - share), lame.mu / 2 * share, elastic::bulk_modulus(lame)});
}

}  // namespace couplet::laws
