// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "thermocline/material/numerics.hpp"
#include "thermocline/material/properties.hpp"
#include "thermocline/wall/surroundings.hpp"

namespace couplet::thermocline {

struct ColumnLayer {
  Insulator material;
  double thickness = 0;  ///< [m]
  int cells = 1;
};

/// Conduction through layers from the inside (the tank) to the outside, in strips side by side that do not
/// exchange heat. Implicit, with conductivities at the old temperature, all strips together cell by cell.
class Layers {
 public:
  /// Sets the steady profile between the surface temperatures.
  void set_steady(std::span<const double> inside, double outside);
  double energy(double reference) const;  ///< [J]
  /// Mean temperature of the outer surface [K].
  double outer_surface(const Film& outside) const;
  /// Cell by cell from the innermost, then by strip [K].
  std::vector<double>& temperature() { return temperature_; }
  const std::vector<double>& temperature() const { return temperature_; }

 protected:
  /// `lengths`: of the strips [m]; the area [m^2] of a plane one. All other data are per length.
  explicit Layers(std::span<const double> lengths) : length_(lengths.begin(), lengths.end()) {}
  /// Adds a cell outside the others. `inwards`, `outwards`: conductances of its halves over the conductivity.
  void add_cell(double inwards, double outwards, double capacity);
  /// Adds the material of the cells since the last call, at the end with the outer surface.
  void add_material(const Insulator& material, double outer_surface);
  /// Performs a step with a film inside, and a heat flow `power` into the inner cell. Sets the heat flow into
  /// each strip [W] and returns the heat lost outside [J]. An infinite coefficient prescribes the surface
  /// temperature; 0 is an insulated side.
  double advance(double dt, std::span<const double> inside, double coefficient, double power,
                 const Film& outside, std::span<double> into);
  void find_conductivity();

  struct LayerMaterial {
    std::size_t cells;
    Ramps conductivity;
  };
  std::vector<LayerMaterial> materials_;
  std::vector<double> length_;
  std::vector<double> shape_;     // conductances of the half cells over the conductivity, 2 per cell
  std::vector<double> capacity_;  // of each cell
  double outer_surface_ = 0;
  std::vector<double> temperature_, k_, up_, inner_, in_;
};

/// Plane layers in one strip: roof, cover, foundation and soil.
class Column final : public Layers {
 public:
  Column(const std::vector<ColumnLayer>& layers, double area);

  struct ColumnHeat {
    double inner = 0, outer = 0;  ///< into the inner side, out of the outer side [J]
  };
  /// Performs a step with a film on each side, or with a given heat flow into the inner side [W].
  ColumnHeat step(double dt, const Film& inner, const Film& outer);
  ColumnHeat step(double dt, double inner_power, const Film& outer);

  /// Response to a heat flow into the inner surface over a step of dt, as coefficient (T_surface - reference)
  /// [W/m^2] with the final surface temperature. Does not change the temperatures.
  Film inner_response(double dt, const Film& outer);

  void set_steady(double inner, double outer) { Layers::set_steady({&inner, 1}, outer); }
  /// Conductance of the inner half cell [W/(m^2 K)].
  double inner_conductance() const;
  double inner_capacity() const { return capacity_.front(); }  ///< of the inner cell [J/(m^2 K)]
  double inner_temperature() const { return temperature_.front(); }
  double area() const { return length_.front(); }
  const std::vector<double>& centre() const { return x_; }  ///< depth of the cells [m]

 private:
  std::vector<double> x_;
};

struct InsulationParameters {
  InsulatorParameters material;
  double thickness = 0.4;  ///< [m], equal on side and roof
  int cells = 8;
  double step = 300;  ///< time step of the insulation [s]
};

/// Insulation around the tank, with a strip per ring of the wall.
class Insulation final : public Layers {
 public:
  /// `dz`: heights of the rings [m]. `radius`: inner radius of the insulation.
  Insulation(const InsulationParameters& parameters, std::span<const double> dz, double radius);

  /// Performs a step of dt at constant inside temperatures. Sets the heat flow from each ring [W] and returns
  /// the heat lost outside [J].
  double step(double dt, std::span<const double> inside, const Film& outside, std::span<double> from_rings);
};

void declare(config::Section& section, InsulationParameters& parameters);

// Films on the surfaces of these layers at the surface temperature. One correction suffices for so weak a
// dependence.
Film side_film_on(const Insulation& blanket, double diameter, double height, const Ambient& air);
Film roof_film_on(const Column& roof, double diameter, const Ambient& air);

}  // namespace couplet::thermocline
