// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <span>
#include <string>
#include <vector>

#include "common/elasticity/finite/finite_law.hpp"

namespace couplet::laws {

/// `lame`: constants at small strain. `coefficients`: further constants of the law; missing ones are zero.
using MakeLaw = elastic::FiniteLaw (*)(const elastic::LameConstants& lame,
                                       std::span<const double> coefficients);

/// Law with its name in the YAML file.
struct Entry {
  const char* name;
  MakeLaw make;
  std::size_t n_coefficients;  ///< largest number
  const char* coefficients;    ///< their names
};

/// All laws, in the order of the documentation.
std::span<const Entry> all();
/// nullptr if there is no law of this name.
const Entry* find(const std::string& name);
/// Like find(); without a name the first law, Saint Venant-Kirchhoff.
const Entry* of(const std::string& name);
std::vector<std::string> names();

/// Functions of four values at once; those of one number are from the standard library.
using std::cbrt;
using std::log;
inline elastic::Four log(const elastic::Four& x) {
  return elastic::Four{std::log(x[0]), std::log(x[1]), std::log(x[2]), std::log(x[3])};
}
inline elastic::Four cbrt(const elastic::Four& x) {
  return elastic::Four{std::cbrt(x[0]), std::cbrt(x[1]), std::cbrt(x[2]), std::cbrt(x[3])};
}

/// Invariants of the isochoric deformation, i1 = J^-2/3 I1 and i2 = J^-4/3 I2, and the energy of a function
/// psi(i1, i2) by the chain rule.
template <class T>
struct Isochoric {
  T i1, i2;
  explicit Isochoric(const T& I1, const T& I2, const T& J) : J_(J) {
    const T root = cbrt(J);
    a_ = 1.0 / (root * root);
    b_ = a_ * a_;
    i1 = a_ * I1;
    i2 = b_ * I2;
  }
  /// `psi`: w, w1, w2, w11, w12, w22, derivatives by i1 and i2.
  elastic::EnergyOf<T> energy(const elastic::EnergyOf<T>& psi) const {
    elastic::EnergyOf<T> e;
    const T r = 1.0 / J_, x = -2. / 3 * r * i1, y = -4. / 3 * r * i2;  // di1/dJ, di2/dJ
    const T xx = 10. / 9 * r * r * i1, yy = 28. / 9 * r * r * i2;
    e.w = psi.w;
    e.w1 = a_ * psi.w1;
    e.w2 = b_ * psi.w2;
    e.wj = x * psi.w1 + y * psi.w2;
    e.w11 = a_ * a_ * psi.w11;
    e.w12 = a_ * b_ * psi.w12;
    e.w22 = b_ * b_ * psi.w22;
    e.w1j = a_ * (-2. / 3 * r * psi.w1 + x * psi.w11 + y * psi.w12);
    e.w2j = b_ * (-4. / 3 * r * psi.w2 + x * psi.w12 + y * psi.w22);
    e.wjj = xx * psi.w1 + yy * psi.w2 + x * x * psi.w11 + 2.0 * x * y * psi.w12 + y * y * psi.w22;
    return e;
  }

 private:
  T J_, a_, b_;
};

/// U = K/2 (J - 1)^2.
template <class T>
elastic::BulkOf<T> quadratic_bulk(double K, const T& J) {
  return {0.5 * K * (J - 1.0) * (J - 1.0), K * (J - 1.0), K + 0.0 * J};
}

/// FiniteLaw of a struct that provides
///   static constexpr bool has_bulk, has_second_invariant;
///   template <class T> EnergyOf<T> shape(const T& I1, const T& I2, const T& J) const;   without the bulk part
///   template <class T> BulkOf<T> bulk(const T& J) const;
template <class Law>
elastic::FiniteLaw finite_law(const Law& law) {
  const auto evaluate = [law](std::span<const elastic::Invariants> at, bool with_bulk,
                              std::span<elastic::Energy> energy) {
    for (std::size_t i = 0; i < at.size(); ++i) {
      energy[i] = law.shape(at[i].i1, at[i].i2, at[i].j);
      if (!with_bulk || !Law::has_bulk) continue;
      const elastic::BulkOf<elastic::Four> bulk = law.bulk(at[i].j);
      energy[i].w += bulk.u;
      energy[i].wj += bulk.pressure;
      energy[i].wjj += bulk.modulus;
    }
  };
  return {evaluate, [law](double j) { return law.bulk(j); }, Law::has_bulk, Law::has_second_invariant};
}

}  // namespace couplet::laws
