// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "thermocline/base/tridiagonal.hpp"
#include "thermocline/material/properties.hpp"
#include "thermocline/wall/environment.hpp"

namespace couplet::thermocline {

struct ColumnLayer {
  Insulator material;
  double thickness = 0;  ///< [m]
  int cells = 1;
};

/// Plane conduction through layers, from the inside (next to the tank) to the outside: roof, cover,
/// foundation and soil. Implicit; conductivity at the temperature before the step.
class Column {
 public:
  Column(const std::vector<ColumnLayer>& layers, double area);

  /// Through a film on each side; a coefficient of infinity is a given surface temperature, 0 an insulated
  /// one.
  struct Heat {
    double inner = 0, outer = 0;  ///< entered through the inner side, left through the outer side [J]
  };
  Heat step(double dt, const Film& inner, const Film& outer);
  /// The same with a given heat flow into the inner side [W].
  Heat step(double dt, double inner_power, const Film& outer);

  /// What a heat flow into the inner surface will meet over a step of dt: it enters as coefficient (T_surface
  /// - reference) [W/m^2] of the surface's temperature at the end of the step. Changes nothing.
  Film inner_response(double dt, const Film& outer);

  /// Steady profile between two surface temperatures.
  void set_steady(double inner, double outer);
  void set_uniform(double temperature) { temperature_.assign(temperature_.size(), temperature); }
  double energy(double reference) const;  ///< [J]
  /// Of the inner and outer half cell [W/(m^2 K)].
  double inner_conductance() const;
  double outer_conductance() const;
  double inner_capacity() const { return capacity_.front(); }  ///< of the inner cell [J/(m^2 K)]
  double inner_temperature() const { return temperature_.front(); }
  /// Of the outer surface against the film that the last step used [K].
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
  std::vector<Table> conductivity_;  // of each layer
  std::vector<int> layer_;
  std::vector<double> x_, dx_, capacity_, temperature_;
  std::vector<double> k_, a_, b_, c_, r_;
  Tridiagonal matrix_;
};

}  // namespace couplet::thermocline
