// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "common/coupling/participant.hpp"
#include "thermocline/bed/bed_parameters.hpp"
#include "thermocline/material/numerics.hpp"
#include "thermocline/material/properties.hpp"

namespace couplet::thermocline {

struct Plate {
  double height = 0, thickness = 0;  // [m]
};

struct ShellParameters {
  SteelParameters material;
  std::vector<Plate> plates;  ///< from the bottom up; the last one continues to the top
};

/// Geometry of the wall: one ring per cell of the bed, and further ones around the ullage.
struct Rings {
  Rings(const ShellParameters& parameters, const BedGrid& bed, double diameter, double height_above_bed);

  double diameter;
  int in_bed;                            ///< number of rings next to the bed
  std::vector<double> z, dz, thickness;  ///< [m]
  int size() const { return int(z.size()); }
  /// Inner surface of a ring [m^2].
  double surface(int i) const;
};

/// Temperature of the wall as thin metal rings with conduction along z. Implicit, with properties at the old
/// temperature:
///   rho c e dT/dt = h_w (T_f - T) + d/dz(k e dT/dz) - q
class Shell {
 public:
  Shell(const Rings& rings, const Steel& steel);

  /// Performs a step of dt next to fluid at `fluid` (per ring in the bed, constant) with coefficients `film`
  /// [W/(m^2 K)]. `lost`: heat flow out of each ring [W] (insulation, ullage). Returns the heat flow from the
  /// bed's cells [W].
  void step(double dt, std::span<const double> fluid, std::span<const double> film,
            std::span<const double> lost, std::vector<double>& from_bed);
  std::vector<double>& temperature() { return temperature_; }
  const std::vector<double>& temperature() const { return temperature_; }
  void set_temperature(std::span<const double> temperature);
  /// Heat content relative to a temperature [J]: exactly the heat received less the heat given.
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

/// The wall as a separate solid program instead of the rings' membrane.
struct ExternalWallParameters {
  int sections = 400;   ///< along the height of the wall
  double angle = 0.01;  ///< of the wall's wedge in that program [rad]
};
void declare(config::Section& section, ExternalWallParameters& parameters);

/// Inner side of the wall for the coupler: a strip of the cylinder with one face per section, symmetric about
/// the plane y = 0, with z from the tank's bottom. Gives at the faces
///   temperature  K   of the ring (t^{n+1})
///   pressure     Pa  of fluid and filler, pushes outward
/// and takes `displacement` at the vertices, relative to the unloaded wall at the solid's reference
/// temperature.
class WallInterface {
 public:
  WallInterface(const ExternalWallParameters& parameters, const Rings& rings);
  int sections() const { return sections_; }
  coupling::Interface describe() const;  ///< places only

  /// Mean of a ring quantity over each section.
  std::vector<double> to_sections(std::span<const double> rings) const;
  /// Radial displacement [m] of each ring from the displacement of the vertices (3 components each).
  std::vector<double> radial(std::span<const double> displacement) const;
  /// Distributes amounts of the sections to the rings by height.
  std::vector<double> to_rings(std::span<const double> amounts) const;

 private:
  double radius_, angle_, height_;
  int sections_;
  std::vector<double> ring_z_, ring_dz_;
};

}  // namespace couplet::thermocline
