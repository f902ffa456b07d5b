// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "thermocline/material/properties.hpp"

namespace couplet::thermocline {

/// Axial conduction of the fluid phase, per area of the whole cross section.
enum class Conduction {
  stagnant,  ///< bed at rest (grains conduct and, in a gas, radiate) + 0.5 Re Pr k (Wakao and Kaguei 1982)
  wakao,     ///< 0.7 eps k + 0.5 Re Pr k: the fluid alone, as in the thesis
  constant,  ///< prescribed value
};

struct ClosureParameters {
  Conduction conduction = Conduction::stagnant;
  double conductivity = 0;      ///< [W/(m K)], for Conduction::constant
  double film_coefficient = 0;  ///< between fluid and grains [W/(m^2 K)]; 0 means Wakao's correlation
};

/// Conductivity of a packed bed at rest over that of its fluid (Zehner and Schluender 1970); kappa = k_s/k_f.
/// `radiation` is that between grains as a conductivity over k_f (Zehner, Bauer and Schluender 1978), 0 without.
double zehner_schluender(double porosity, double kappa, double radiation = 0);
/// Conductivity of a bed at rest [W/(m K)]. Grains radiate if the fluid is transparent and they have an emissivity.
double stagnant_conductivity(const Medium& fluid, const Filler& filler, double porosity, double diameter,
                             double kelvin);

/// Transfer coefficients at one temperature and mass flux.
struct Closure {
  double film = 0;          ///< fluid-grain [W/(m^2 K)]
  double conductivity = 0;  ///< axial [W/(m K)]
  double wall = 0;          ///< fluid-wall [W/(m^2 K)]
};

/// Powers of the mass flux G = |m|/S, used by all cells of a step.
struct MassFlux {
  explicit MassFlux(double g);
  double g, g_film, g_third, g_wall;
};

/// Closures of one layer of the bed (porosity, grain diameter). Temperature-dependent parts are tabulated
/// once, so that a cell needs one look-up at a given flux. Every correlation used here is a sum of f(T) G^n,
/// so Re and Pr are not needed.
class LayerClosure {
 public:
  LayerClosure(const ClosureParameters& parameters, const Medium& fluid, const Filler& filler,
               double porosity, double diameter);
  Closure at(double temperature, const MassFlux& flux) const;
  /// Evaluates film, conductivity and wall coefficients of many cells at once.
  void fill(std::span<const double> temperature, const MassFlux& flux, double* film, double* conductivity,
            double* wall) const;
  /// Re based on the superficial velocity.
  double reynolds(double temperature, double flux) const;

 private:
  struct Node {
    double film_still, film_flow, conduction_still, wall_still, wall_third, wall_flow;
  };
  Node node_at(double temperature) const;

  ClosureParameters parameters_;
  Medium fluid_;
  Filler filler_;
  double porosity_, diameter_, first_, inverse_spacing_;
  std::vector<Node> nodes_;
};

}  // namespace couplet::thermocline
