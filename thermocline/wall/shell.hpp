// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "thermocline/base/tridiagonal.hpp"
#include "thermocline/bed/bed_grid.hpp"
#include "thermocline/material/properties.hpp"

namespace couplet::thermocline {

struct Plate {
  double height = 0, thickness = 0;  // [m]
};

struct ShellParameters {
  SteelParameters material;
  std::vector<Plate> plates;  ///< from the bottom up; the last one goes on to the top
  double roof_pressure = 0;   ///< weight of the roof per area of the roof [Pa]
};

/// Geometry of the wall: one ring for each cell of the bed, and further ones around the ullage.
struct Rings {
  Rings(const ShellParameters& parameters, const BedGrid& bed, double diameter, double height_above_bed);

  double diameter;
  int in_bed;                            ///< rings beside the bed
  std::vector<double> z, dz, thickness;  ///< [m]
  int size() const { return int(z.size()); }
  /// Inner surface of a ring [m^2].
  double surface(int i) const;
};

/// Temperature of the wall: a metal ring thin enough to have one temperature at each height, conduction along
/// z.
///   rho c e dT/dt = h_w (T_f - T) + d/dz(k e dT/dz) - q
/// Implicit; the metal's properties at the temperature before the step.
class Shell {
 public:
  Shell(const Rings& rings, const Steel& steel);

  /// Over dt, beside fluid of temperature `fluid` (a value a ring in the bed, held) through the coefficients
  /// `film` [W/(m^2 K)]; `lost` leaves each ring [W] (insulation, ullage). Fills what the bed's cells give
  /// [W].
  void step(double dt, std::span<const double> fluid, std::span<const double> film,
            std::span<const double> lost, std::vector<double>& from_bed);
  std::span<const double> temperature() const { return temperature_; }
  void set_temperature(std::span<const double> temperature);
  /// Heat content above a temperature [J]: the heat that came in less what went out, exact over steps.
  double energy(double reference) const;

 private:
  const Rings* rings_;
  const Steel* steel_;
  Ramps specific_heat_of_, conductivity_of_;
  std::vector<double> mass_, bare_;  // of each ring [kg]; dz/(2 pi D e) [1/m]
  std::vector<double> temperature_, a_, b_, c_, r_, coupling_, specific_heat_, resistance_;
  Tridiagonal matrix_;
};

void declare(config::Section& section, ShellParameters& parameters);

}  // namespace couplet::thermocline
