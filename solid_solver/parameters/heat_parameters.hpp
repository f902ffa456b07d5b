// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <optional>
#include <string>

#include "common/config/section.hpp"

namespace couplet::solid {

/// Thermal properties of a material; each is required only by effects that use it. Tables depend on T [K].
struct HeatMaterial {
  std::optional<config::ExpressionText> conductivity;                    // [W/(m K)]
  std::optional<config::ExpressionText> specific_heat;                   // [J/(kg K)]
  std::optional<config::ExpressionText> expansion;                       // instantaneous coefficient [1/K]
  std::optional<config::ExpressionText> youngs_modulus, poissons_ratio;  // tables; absent if constant
};

/// Thermal boundary condition on one patch.
struct HeatBoundary {
  enum class Type { temperature, flux, convection, adiabatic, symmetry, interface };
  Type type = Type::adiabatic;
  config::ExpressionText value;        // temperature [K] or heat flux into the solid [W/m^2]
  config::ExpressionText coefficient;  // of convection [W/(m^2 K)]
  config::ExpressionText ambient;      // ambient temperature [K]
  bool carries_heat() const { return type != Type::adiabatic && type != Type::symmetry; }
};

/// Heat conduction, thesis (2.35).
struct HeatParameters {
  enum class Analysis { transient, steady };
  enum class Scheme { euler, three_point, trapezoidal };
  Analysis analysis = Analysis::transient;
  Scheme scheme = Scheme::three_point;
  config::ExpressionText initial_temperature{"293.15"};  // [K]
  config::ExpressionText source;                         // [W/m^3]
  std::map<std::string, HeatBoundary> boundaries;
  double tolerance = 1e-8;  // relative, of the temperature, if properties depend on it
  int max_iterations = 50;
  /// Relative residual of the linear system, where it is not solved directly.
  static constexpr double linear_tolerance = 1e-12;
};

/// Thermal strain relative to a reference temperature.
struct ThermalExpansion {
  double reference_temperature = 293.15;  // [K]
};

void declare(config::Section& section, HeatMaterial& material);
void declare(config::Section& section, HeatParameters& heat);
void declare(config::Section& section, ThermalExpansion& expansion);

}  // namespace couplet::solid
