// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "thermocline/wall/mechanics.hpp"

namespace couplet::thermocline {

/// What bending makes of the rings' stresses: the wall as a thin axisymmetric shell [timoshenko1959, chapter
/// 15]
///   d2/dz2 (D d2w/dz2) + E e/a^2 (w - w_m) = 0,   D = E e^3/(12 (1 - nu^2)),
/// w_m the radial displacement that each ring has by itself (its stress and its thermal expansion), ends
/// free. The displacement is rounded off over 1/beta, beta^4 = 3 (1 - nu^2)/(a^2 e^2), and bends the wall: a
/// step of dT in temperature makes an axial stress of 0.293 E alpha dT at both faces (nu = 0.3).
struct WallBending {
  std::vector<double> hoop;   ///< E (w/a - thermal strain), mean over the thickness [Pa]
  std::vector<double> axial;  ///< at the outer face, 6 M/e^2; opposite at the inner [Pa]
};
WallBending wall_bending(const Rings& rings, const Steel& steel, std::span<const double> hoop,
                         std::span<const double> temperature);

/// Largest share of its yield strength that the equivalent stress of a ring has: without bending, and at the worse of both
/// faces with it, where bending adds -+6 M/e^2 along z and nu times that along the circumference [1].
struct YieldShares {
  double rings = 0, shell = 0;
};
YieldShares yield_shares(const WallStress& stress, const WallBending& bent, double poissons_ratio);

}  // namespace couplet::thermocline
