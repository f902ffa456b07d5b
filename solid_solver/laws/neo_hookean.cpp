// SPDX-License-Identifier: Apache-2.0
#include "solid_solver/laws/laws.hpp"

namespace couplet::laws {
namespace {

/// Thesis (2.31), sigma = mu/J (B - I) + lambda/J ln J I: W = mu/2 (I1 - 3) - mu ln J + lambda/2 (ln J)^2.
struct NeoHookean {
  static constexpr bool has_bulk = true, has_second_invariant = false;
  double mu, lambda;

  template <class T>
  elastic::EnergyOf<T> shape(const T& I1, const T&, const T& J) const {
    elastic::EnergyOf<T> e;
    e.w = mu / 2 * (I1 - 3.0) - mu * log(J);
    e.w1 = mu / 2 + 0.0 * J;
    e.wj = -mu / J;
    e.wjj = mu / (J * J);
    return e;
  }
  template <class T>
  elastic::BulkOf<T> bulk(const T& J) const {
    const T l = log(J);
    return {lambda / 2 * l * l, lambda * l / J, lambda * (1.0 - l) / (J * J)};
  }
};

}  // namespace

elastic::FiniteLaw neo_hookean(const elastic::LameConstants& lame, std::span<const double>) {
  return finite_law(NeoHookean{lame.mu, lame.lambda});
}

}  // namespace couplet::laws
