// SPDX-License-Identifier: Apache-2.0
#include "solid_solver/laws/laws.hpp"

namespace couplet::laws {
namespace {

/// Rubber with strain stiffening [yeoh1993]: W = c1 x + c2 x^2 + c3 x^3 + K/2 (J - 1)^2 with x = i1 - 3 of
/// the isochoric i1. The small-strain shear modulus is 2 c1.
struct Yeoh {
  static constexpr bool has_bulk = true, has_second_invariant = false;
  double c1, c2, c3, K;

  template <class T>
  elastic::EnergyOf<T> shape(const T& I1, const T& I2, const T& J) const {
    const Isochoric<T> iso(I1, I2, J);
    const T x = iso.i1 - 3.0;
    elastic::EnergyOf<T> psi;
    psi.w = x * (c1 + x * (c2 + x * c3));
    psi.w1 = c1 + x * (2 * c2 + 3 * c3 * x);
    psi.w11 = 2 * c2 + 6 * c3 * x;
    return iso.energy(psi);
  }
  template <class T>
  elastic::BulkOf<T> bulk(const T& J) const {
    return quadratic_bulk(K, J);
  }
};

}  // namespace

elastic::FiniteLaw yeoh(const elastic::LameConstants& lame, std::span<const double> coefficients) {
  const auto ratio = [&](std::size_t i) { return i < coefficients.size() ? coefficients[i] : 0.0; };
  const double c1 = lame.mu / 2;
  return finite_law(Yeoh{c1, c1 * ratio(0), c1 * ratio(1), elastic::bulk_modulus(lame)});
}

}  // namespace couplet::laws
