// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Materials of thesis table 5.1 (with misprints corrected), insulation and foundation materials, and
/// user-defined materials. Temperatures in K, all units SI.

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "common/config/section.hpp"
#include "common/fv/table.hpp"
#include "thermocline/material/numerics.hpp"

namespace couplet::thermocline {

// Units and plausible ranges of quantities that several elements use.
inline config::Key& as_temperature(config::Key&& key) { return key.unit("K", 70, 5000); }
inline config::Key& as_difference(config::Key&& key) { return key.unit("K difference", 0.1, 500); }
inline config::Key& as_density(config::Key&& key) { return key.unit("kg/m^3", 0.05, 25000); }
inline config::Key& as_thickness(config::Key&& key) { return key.unit("m", 1e-4, 30); }
inline config::Key& as_length(config::Key&& key) { return key.unit("m", 0.01, 100); }
inline config::Key& as_tank_length(config::Key&& key) {
  return key.unit("m", 0.01, 300).positive().required();
}
inline config::Key& as_step(config::Key&& key) { return key.unit("s", 0.1, 1e5); }
inline config::Key& as_specific_heat(config::Key&& key) { return key.unit("J/(kg K)", 10, 1e5); }
inline config::Key& as_conductivity(config::Key&& key) { return key.unit("W/(m K)", 1e-3, 1e7); }
inline config::Key& as_film(config::Key&& key) { return key.unit("W/(m^2 K)", 1e-3, 1e7); }

/// Declares a section by `declare` of its parameters; optional for a std::optional.
template <class T>
void declare_section(config::Section& s, const char* name, T& value, const char* doc) {
  s.section(
      name, [&value](config::Section& q) { declare(q, value); }, doc);
}
template <class T>
void declare_section(config::Section& s, const char* name, std::optional<T>& value, const char* doc) {
  s.optional_section<T>(
      name, value, [](config::Section& q, T& v) { declare(q, v); }, doc);
}

inline constexpr double gravity = 9.81;        // [m/s^2]
inline constexpr double lightest_liquid = 50;  // [kg/m^3]

/// Density as a polynomial of temperature in degC.
struct DensityLaw {
  double constant = 0, slope = 0, curve = 0;  // [kg/m^3], [kg/(m^3 K)], [kg/(m^3 K^2)]
  double at(double kelvin) const {
    const double c = celsius(kelvin);
    return constant + c * (slope + c * curve);
  }
  /// Integral from one temperature to another [kg K/m^3].
  double between(double from, double to) const {
    const double a = celsius(from), b = celsius(to), d = b - a;
    return d * (constant + 0.5 * slope * (a + b) + curve / 3 * (a * a + a * b + b * b));
  }
};

/// Value of a property at a temperature, which does not count as use of its table.
inline double value_of(const fv::Property& property, double kelvin) {
  const fv::Table* table = property.table();
  return table ? (*table)(std::clamp(kelvin, table->at().front(), table->at().back())) : property(kelvin);
}

/// Heat-transfer fluid. The specific heat is constant, and so is the density unless `real_density` is set
/// (thesis table 5.1); plant and tank use both for heat. Conductivity and viscosity depend on temperature.
struct Medium {
  std::string name;
  double density = 0, specific_heat = 0;       // [kg/m^3], [J/(kg K)]
  std::function<double(double)> conductivity;  // [W/(m K)] of [K]
  std::function<double(double)> viscosity;     // [Pa s] of [K]
  double lowest = 0, highest = 1e4;            // range in which the liquid is stable [K]
  std::optional<DensityLaw> real = {};         // measured density, if known
  bool real_density = false;                   // the tank uses it
  double gas_constant = 0, pressure = 101325;  // of an ideal gas [J/(kg K)], [Pa]; 0 for a liquid
  double known_from = 0, known_to = 1e4;       // range of user-defined tables [K]
  bool is_gas() const { return gas_constant > 0; }
  /// Transparent to thermal radiation: air, and what the user defines as light as a gas.
  bool is_transparent() const { return is_gas() || density < lightest_liquid; }
  double volumetric() const { return density * specific_heat; }
  double density_at(double kelvin) const { return real_density ? real->at(kelvin) : density; }
};

/// Grains of sand and rock.
struct Filler {
  double density = 2643;                                    // quartzite, table 5.1
  fv::Property specific_heat = 1000.5, conductivity = 2.2;  // [J/(kg K)], [W/(m K)]
  double friction_angle = 0.5235987755982988;               // [rad]; 30 degrees
  double expansion = 7.92e-6;                               // linear [1/K]
  double emissivity = 0.85;                                 // [1]; 0 leaves radiation out
  double volumetric(double kelvin) const { return density * value_of(specific_heat, kelvin); }
  bool depends_on_temperature() const { return !specific_heat.is_constant() || !conductivity.is_constant(); }
};

/// Melting of capsules over a temperature range, with uniformly distributed latent heat.
struct Melting {
  double temperature = 0;  ///< middle of the range [K]
  double width = 2;        ///< width of the range [K]
  double latent_heat = 0;  ///< [J/kg]
};
void declare(config::Section& section, Melting& melting);

/// Metal of the shell. `expansion` is the instantaneous coefficient d(strain)/dT, as in ASME II-D, and the
/// thermal strain its integral. (Products alpha (T - T0) of a mean coefficient would be too large by a
/// third.)
struct Steel {
  std::string name;
  double density = 7850, poissons_ratio = 0.3;
  Curve specific_heat, conductivity, youngs_modulus, expansion, yield_strength;
  double highest = 1e4;  // [K]
  /// Strain from the lower end of the table to this temperature [1].
  double thermal_strain(double temperature) const { return expansion.integral(temperature); }
};

/// Material that only conducts: insulation, foundation, soil.
struct Insulator {
  double density = 0, specific_heat = 0;
  Curve conductivity;
};

Medium solar_salt();
Medium caloria_ht43();
/// Dry air as an ideal gas: constant specific heat, conductivity and viscosity by Sutherland's laws. The
/// small heat content of the pores uses the density at the reference temperature, Ergun's equation the
/// current one.
Medium air_at(double pressure, double reference_temperature, double specific_heat = 1075);
/// Sutherland's laws [W/(m K)], [Pa s].
double air_conductivity(double temperature);
double air_viscosity(double temperature);
/// Heat of a kilogram of dry air between two temperatures [J/kg], by the standard fit of its specific heat;
/// reference for runs with a constant one.
double air_heat_between(double from, double to);
Steel steel_a537();     // A537 class 2, 477-577 K
Steel steel_a387();     // A387 grade 91, 563-663 K
Steel nickel_n06022();  // 563-838 K
/// Wired mineral-wool mat of 100 kg/m^3.
Insulator mineral_wool();
/// Foundation layers by name ("dry-sand", "foam-glass", ...). Throws std::out_of_range for an unknown one.
Insulator foundation_material(const std::string& name);
std::vector<std::string> foundation_materials();

// -- as written in the YAML file
// -----------------------------------------------------------------------------
struct MediumInput {
  enum class Type { solar_salt, caloria_ht43, air, custom } type = Type::solar_salt;
  double pressure = 101325, reference_temperature = 600;  ///< of air [Pa], [K]
  double air_specific_heat = 1075;                        ///< of air: its mean from 300 to 900 K [J/(kg K)]
  bool real_density = false;
  double density = 0, specific_heat = 0;
  std::vector<double> temperature, conductivity, viscosity;
};
void declare(config::Section& section, MediumInput& parameters);
Medium make_fluid(const MediumInput& parameters);

struct FillerParameters {
  double density = Filler().density;
  config::ExpressionText specific_heat{"1000.5"}, conductivity{"2.2"};
  double friction_angle = Filler().friction_angle, expansion = Filler().expansion,
         emissivity = Filler().emissivity;
};
void declare(config::Section& section, FillerParameters& parameters);
Filler make_filler(const FillerParameters& parameters);

struct SteelParameters {
  enum class Type { a537, a387, n06022, custom } type = Type::a537;
  double density = 7850, poissons_ratio = 0.3;
  std::vector<double> temperature, specific_heat, conductivity, youngs_modulus, expansion, yield_strength;
};
void declare(config::Section& section, SteelParameters& parameters);
Steel make_steel(const SteelParameters& parameters);

struct InsulatorParameters {
  double density = 100, specific_heat = 840;
  std::vector<double> temperature, conductivity;  // both empty for mineral wool
};
void declare(config::Section& section, InsulatorParameters& parameters);
Insulator make_insulator(const InsulatorParameters& parameters);

/// Heat content of grains per volume by temperature: the integral of rho c, and the latent heat of a melting range.
/// The capacity is piecewise linear, and constant beyond the ends of its table.
class GrainHeat {
 public:
  GrainHeat(const Filler& filler, const std::optional<Melting>& melting);
  /// Relative to the first node, to avoid loss of digits [J/m^3].
  double heat(double kelvin) const;
  double temperature(double heat) const;
  /// Apparent capacity dh/dT [J/(m^3 K)].
  double capacity(double kelvin) const;

 private:
  /// Values at the lower end, and the slope of the capacity. The first piece also holds below it.
  struct HeatPiece {
    double from, heat, capacity, slope;  // [K], [J/m^3], [J/(m^3 K)], [J/(m^3 K^2)]
  };
  const HeatPiece& piece(double HeatPiece::*member, double value) const;
  std::vector<HeatPiece> pieces_;
};

}  // namespace couplet::thermocline
