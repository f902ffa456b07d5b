// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <utility>

#include "common/config/section.hpp"
#include "common/fv/table.hpp"

namespace couplet::fluid {

// clang-format off
/// Dynamic viscosity of a generalized Newtonian fluid [Pa s], a function of the shear rate q = (2 D:D)^(1/2) [1/s], times a factor that
/// depends on the temperature:
///   power law         K q^(n-1), between `least` and `most`
///   Carreau-Yasuda    mu_inf + (mu_0 - mu_inf) [1 + (T q)^a]^((n-1)/a)              [bird1987], (4.1-9)
///   Cross             mu_inf + (mu_0 - mu_inf)/[1 + (T q)^(1-n)]                    [cross1965]
///   Herschel-Bulkley  K q^(n-1) + tau_0 (1 - exp(-m q))/q, with q of at least 1/m in the first term if n < 1
///                                                                                  [papanastasiou1987]
// clang-format on
struct ViscosityLaw {
  enum class Type { power_law, carreau_yasuda, cross, herschel_bulkley };
  Type type = Type::power_law;
  double index = 1;                           // n
  double consistency = 0;                     // K [Pa s^n]
  double least = 0;                           // [Pa s]
  std::optional<double> most;                 // [Pa s]; absent if unlimited
  double zero_shear = 0, infinite_shear = 0;  // mu_0, mu_inf [Pa s]
  double time = 0;                            // T [s]
  double yasuda = 2;                          // a
  double yield_stress = 0;                    // tau_0 [Pa]
  double regularization = 0;                  // m [s]
  std::optional<config::ExpressionText> by_temperature;

  /// Viscosity [Pa s] at a shear rate [1/s] and a factor of 1.
  double operator()(double shear_rate) const;
  /// Factor of the temperature [K].
  fv::Property factor() const;
  /// Bounds of the factor.
  std::pair<double, double> factors() const;
  /// Lower bound over all shear rates and temperatures [Pa s]; the viscosity itself if that is constant.
  double smallest() const { return smallest_by_shear() * factors().first; }
  /// Upper bound over all shear rates and temperatures [Pa s]; infinity if there is none.
  double largest() const { return largest_by_shear() * factors().second; }
  /// Upper bound of the slope of log(stress) over log(shear rate), but at least 1: a change of the strain rate is resisted
  /// by at most this multiple of the viscosity.
  double stiffening() const { return index > 1 ? index : 1; }

 private:
  double smallest_by_shear() const;
  double largest_by_shear() const;
};

/// Declares the keys of a law.
void declare(config::Section& section, ViscosityLaw& law);

}  // namespace couplet::fluid
