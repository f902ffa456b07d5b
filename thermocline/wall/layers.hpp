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

/// Plane conduction through layers, from the inside (the tank) to the outside: roof, cover, foundation and
/// soil. Implicit, with conductivities at the old temperature.
class Column {
 public:
  Column(const std::vector<ColumnLayer>& layers, double area);

  /// Performs a step with a film on each side. An infinite coefficient prescribes the surface temperature; 0
  /// is an insulated side.
  struct Heat {
    double inner = 0, outer = 0;  ///< into the inner side, out of the outer side [J]
  };
  Heat step(double dt, const Film& inner, const Film& outer);
  /// Performs a step with a given heat flow into the inner side [W].
  Heat step(double dt, double inner_power, const Film& outer);

  /// Response to a heat flow into the inner surface over a step of dt, as coefficient (T_surface - reference)
  /// [W/m^2] with the final surface temperature. Does not change the state.
  Film inner_response(double dt, const Film& outer);

  /// Sets the steady profile between two surface temperatures.
  void set_steady(double inner, double outer);
  double energy(double reference) const;  ///< [J]
  /// Conductance of the inner and the outer half cell [W/(m^2 K)].
  double inner_conductance() const;
  double outer_conductance() const;
  double inner_capacity() const { return capacity_.front(); }  ///< of the inner cell [J/(m^2 K)]
  double inner_temperature() const { return temperature_.front(); }
  /// Temperature of the outer surface for the film of the last step [K].
  double outer_surface(const Film& outer) const;
  double area() const { return area_; }

  std::vector<double>& temperature() { return temperature_; }
  const std::vector<double>& temperature() const { return temperature_; }
  const std::vector<double>& centre() const { return x_; }  ///< depth of the cells [m]

 private:
  void fill(double dt, const Film& outer);
  Heat advance(double dt, double inner_conductance, double inner_reference, double inner_power,
               const Film& outer);

  double area_;
  std::vector<Table> conductivity_;  // per layer
  std::vector<int> layer_;
  std::vector<double> x_, dx_, capacity_, temperature_;
  std::vector<double> k_, resistance_, a_, b_, c_, r_;
  Tridiagonal matrix_;
};

struct InsulationParameters {
  InsulatorParameters material;
  double thickness = 0.4;  ///< [m], equal on side and roof
  int cells = 8;
  double step = 300;  ///< time step of the insulation [s]
  OutsideParameters outside;
};

/// Radial conduction through the insulation around the tank, with a column of `cells` nodes per ring of the
/// wall. Implicit, all rings together node by node.
class Insulation {
 public:
  /// `dz`: heights of the rings [m]. `radius`: inner radius of the insulation.
  Insulation(const InsulationParameters& parameters, std::span<const double> dz, double radius);

  /// Performs a step of dt at constant inside temperatures. Sets the heat flow from each ring [W] and returns
  /// the heat lost outside [J].
  double step(double dt, std::span<const double> inside, const Film& outside,
              std::vector<double>& from_rings);
  void set_steady(std::span<const double> inside, double outside);
  double energy(double reference) const;  ///< [J]
  /// Mean temperature of the outer surface [K].
  double outer_surface(const Film& outside) const;
  std::vector<double>& temperature() { return temperature_; }
  const std::vector<double>& temperature() const { return temperature_; }

 private:
  Table conductivity_;
  Ramps ramps_;  // of conductivity_
  int cells_;
  std::size_t rings_;
  std::vector<double> dz_;
  std::vector<double> shape_;     // 2 pi/ln(r_out/r_in) of the half cells, 2 per node [1]
  std::vector<double> capacity_;  // per height, for each node [J/(m K)]
  double outer_circumference_;
  std::vector<double> temperature_;  // by node from the innermost, then by ring [K]
  std::vector<double> k_, up_, inner_, in_, nothing_;
};

void declare(config::Section& section, InsulationParameters& parameters);

// Films on the surfaces of these layers at the surface temperature. One correction suffices for so weak a
// dependence.
Film side_film_on(const Insulation& blanket, const OutsideParameters& p, double diameter, double height,
                  const Ambient& air);
Film roof_film_on(const Column& roof, const OutsideParameters& p, double diameter, const Ambient& air);

}  // namespace couplet::thermocline
