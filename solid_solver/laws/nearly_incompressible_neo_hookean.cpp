// SPDX-License-Identifier: Apache-2.0
#include "solid_solver/laws/laws.hpp"

namespace couplet::laws {
namespace {

/// Thesis (2.32) with its erratum (mu and K interchanged), sigma = K (J - 1) I + mu J^-5/3 dev B [bonet2008]:
/// W = mu/2 (J^-2/3 I1 - 3) + K/2 (J - 1)^2.
struct NearlyIncompressible {
  static constexpr bool has_bulk = true, has_second_invariant = false;
  double mu, K;

  template <class T>
  elastic::EnergyOf<T> shape(const T& I1, const T& I2, const T& J) const {
    const Isochoric<T> iso(I1, I2, J);
    elastic::EnergyOf<T> psi;
    psi.w = mu / 2 * (iso.i1 - 3.0);
    psi.w1 = mu / 2 + 0.0 * J;
    return iso.energy(psi);
  }
  template <class T>
  elastic::BulkOf<T> bulk(const T& J) const {
    return quadratic_bulk(K, J);
  }
};

}  // namespace

elastic::FiniteLaw nearly_incompressible_neo_hookean(const elastic::LameConstants& lame,
                                                     std::span<const double>) {
  return finite_law(NearlyIncompressible{lame.mu, elastic::bulk_modulus(lame)});
}

}  // namespace couplet::laws
