// SPDX-License-Identifier: Apache-2.0
#include "solid_solver/laws/laws.hpp"

#include <algorithm>
#include <array>

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

elastic::FiniteLaw saint_venant_kirchhoff(const elastic::LameConstants& lame, std::span<const double>) {
  return finite_law(SaintVenantKirchhoff{lame.mu, lame.lambda});
}

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

elastic::FiniteLaw neo_hookean(const elastic::LameConstants& lame, std::span<const double>) {
  return finite_law(NeoHookean{lame.mu, lame.lambda});
}

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

elastic::FiniteLaw nearly_incompressible_neo_hookean(const elastic::LameConstants& lame,
                                                     std::span<const double>) {
  return finite_law(NearlyIncompressible{lame.mu, elastic::bulk_modulus(lame)});
}

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

elastic::FiniteLaw mooney_rivlin(const elastic::LameConstants& lame, std::span<const double> coefficients) {
  const double share = coefficients.empty() ? 0 : coefficients[0];
  return finite_law(
      MooneyRivlin{lame.mu / 2 * (1 - share), lame.mu / 2 * share, elastic::bulk_modulus(lame)});
}

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

elastic::FiniteLaw yeoh(const elastic::LameConstants& lame, std::span<const double> coefficients) {
  const auto ratio = [&](std::size_t i) { return i < coefficients.size() ? coefficients[i] : 0.0; };
  const double c1 = lame.mu / 2;
  return finite_law(Yeoh{c1, c1 * ratio(0), c1 * ratio(1), elastic::bulk_modulus(lame)});
}

const std::array entries{
    Entry{"saint-venant-kirchhoff", saint_venant_kirchhoff, 0, ""},
    Entry{"neo-hookean", neo_hookean, 0, ""},
    Entry{"nearly-incompressible-neo-hookean", nearly_incompressible_neo_hookean, 0, ""},
    Entry{"mooney-rivlin", mooney_rivlin, 1, "c01 / (c10 + c01)"},
    Entry{"yeoh", yeoh, 2, "c2 / c1, c3 / c1"},
};

}  // namespace

std::span<const Entry> all() { return entries; }

const Entry* find(const std::string& name) {
  const auto found = std::ranges::find(entries, name, [](const Entry& e) { return std::string(e.name); });
  return found == entries.end() ? nullptr : &*found;
}

const Entry* of(const std::string& name) { return name.empty() ? &entries.front() : find(name); }

std::vector<std::string> names() {
  std::vector<std::string> result;
  for (const Entry& e : entries) result.emplace_back(e.name);
  return result;
}

}  // namespace couplet::laws
