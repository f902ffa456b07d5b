// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "common/config/section.hpp"

namespace couplet::fluid {

/// How the pressure follows from the divergence where the fluid is computed as weakly compressible.
enum class WaveScheme { none, three_level, trapezoidal };

/// The compressibility of a fluid: how it is computed, or, with `none`, by what a run judges whether to neglect it was right.
struct CompressibilityParameters {
  WaveScheme scheme = WaveScheme::three_level;
  std::optional<double> mean_time;       // [s], of the means at absorbing boundaries
  std::optional<double> speed_of_sound;  // [m/s]
  std::string substance;                 // one of substances(); empty: not given
  std::optional<double> temperature;     // [K], of the substance
  std::optional<double> pressure;        // [Pa], absolute; with the density: c^2 = gamma p / rho
  std::optional<double> heat_capacity_ratio;
  double upstream_volume = 0;  // [m^3], before the inlets, not in the mesh
  bool is_solved() const { return scheme != WaveScheme::none; }
};
void declare(config::Section& section, CompressibilityParameters& parameters);

/// Gases by molar mass and ratio of heat capacities, liquids by their speed of sound.
std::vector<std::string> substances();

/// Why a fluid of this density [kg/m^3] cannot be the named substance; empty: it can, or none is named.
std::string misfit_of(const CompressibilityParameters& parameters, double density);

struct Sound {
  double speed = 0;  ///< [m/s]
  std::string of;    ///< "sf6 at 20 degC"
};
/// Speed of sound by the keys, else by density [kg/m^3] and viscosity [Pa s], where they are those of a gas at 1 atm or of a liquid. None for a
/// model fluid, such as one of 1 kg/m^3 and 1 Pa s: nothing is known of its sound.
std::optional<Sound> sound_of(const std::optional<CompressibilityParameters>& parameters, double density,
                              double viscosity);

/// Speed of sound of a fluid that is computed as weakly compressible [m/s], else 0. Throws Error if it is not known.
double solved_sound(const std::optional<CompressibilityParameters>& parameters, double density,
                    double viscosity);

}  // namespace couplet::fluid
