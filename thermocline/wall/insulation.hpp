// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "thermocline/material/properties.hpp"
#include "thermocline/wall/environment.hpp"

namespace couplet::thermocline {

struct InsulationParameters {
  InsulatorParameters material;
  double thickness = 0.4;  ///< [m], the same on side and roof
  int cells = 8;
  double step = 300;  ///< its own step [s]
  OutsideParameters outside;
};

/// Radial conduction through the blanket around the tank, one column of `cells` nodes a ring of the wall;
/// implicit, all rings at once node by node.
class Insulation {
 public:
  /// `dz`: heights of the rings [m]; `radius`: where the blanket begins.
  Insulation(const InsulationParameters& parameters, std::span<const double> dz, double radius);

  /// Over dt with the temperatures of what is inside, held. Fills the heat that each ring gives [W]; returns
  /// the heat lost outside [J].
  double step(double dt, std::span<const double> inside, const Film& outside,
              std::vector<double>& from_rings);
  void set_steady(std::span<const double> inside, double outside);
  double energy(double reference) const;  ///< [J]
  /// Mean of the outer surface [K].
  double outer_surface(const Film& outside) const;
  std::vector<double>& temperature() { return temperature_; }
  const std::vector<double>& temperature() const { return temperature_; }

 private:
  Table conductivity_;
  Ramps ramps_;  // the same
  int cells_;
  std::size_t rings_;
  std::vector<double> dz_;
  std::vector<double> shape_;     // 2 pi/ln(r_out/r_in) of the half cells, 2 per node [1]
  std::vector<double> capacity_;  // per height of each node [J/(m K)]
  double outer_circumference_;
  std::vector<double> temperature_;  // node by node, the innermost first; rings within [K]
  std::vector<double> k_, up_, inner_, in_, nothing_;
};

void declare(config::Section& section, InsulationParameters& parameters);

}  // namespace couplet::thermocline
