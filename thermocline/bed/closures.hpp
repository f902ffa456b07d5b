// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "thermocline/material/properties.hpp"

namespace couplet::thermocline {

/// Axial conduction of the fluid phase, per area of the whole cross section.
enum class Conduction {
  wakao,      ///< 0.7 eps k + 0.5 Re Pr k: molecular and dispersion (Wakao and Kaguei 1982)
  molecular,  ///< eps k
  stagnant,   ///< stagnant bed of Zehner and Schluender (grains conduct, too) and the dispersion of wakao
  constant,   ///< prescribed value
};
/// Correlation between fluid and wall; at least that of the stagnant bed, 2 k0/d.
enum class WallFilm { beek, yagi_wakao, constant };

struct ClosureParameters {
  Conduction conduction = Conduction::wakao;
  double conductivity = 0;  ///< [W/(m K)], for Conduction::constant
  WallFilm wall_film = WallFilm::beek;
  double wall_coefficient = 0;  ///< [W/(m^2 K)], for WallFilm::constant
  double film_coefficient = 0;  ///< between fluid and grains [W/(m^2 K)]; 0 means Wakao's correlation
};

/// Stagnant conductivity of a packed bed over that of its fluid; kappa = k_s/k_f (Zehner and Schluender
/// 1970).
double zehner_schluender(double porosity, double kappa);

/// Transfer coefficients at one temperature and mass flux.
struct Closure {
  double film = 0;          ///< fluid-grain [W/(m^2 K)]
  double conductivity = 0;  ///< axial [W/(m K)]
  double wall = 0;          ///< fluid-wall [W/(m^2 K)]
};

/// Powers of the mass flux G = |m|/S, used by all cells of a step.
struct MassFlux {
  explicit MassFlux(double g);
  double g, g_film, g_third, g_wall, g_half;
};

/// Closures of one layer of the bed (porosity, grain diameter). Temperature-dependent parts are tabulated
/// once, so that a cell needs one look-up at a given flux. Every correlation used here is a sum of f(T) G^n,
/// so Re and Pr are not needed.
class LayerClosure {
 public:
  LayerClosure(const ClosureParameters& parameters, const Fluid& fluid, const Filler& filler, double porosity,
               double diameter);
  Closure at(double temperature, const MassFlux& flux) const;
  /// Evaluates film, conductivity and wall coefficients of many cells at once.
  void fill(std::span<const double> temperature, const MassFlux& flux, double* film, double* conductivity,
            double* wall) const;
  /// Re based on the superficial velocity.
  double reynolds(double temperature, double flux) const;

 private:
  struct Node {
    double film_still, film_flow, conduction_still, wall_still, wall_third, wall_flow, wall_half, wall_switch;
  };
  Node node_at(double temperature) const;

  ClosureParameters parameters_;
  Fluid fluid_;
  Filler filler_;
  double porosity_, diameter_, first_, inverse_spacing_;
  std::vector<Node> nodes_;
};

}  // namespace couplet::thermocline
