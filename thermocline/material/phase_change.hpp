// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "thermocline/material/properties.hpp"

namespace couplet::thermocline {

/// Heat of a grain's material over temperature, per volume of the material, with a range in which it melts:
///   h(T) = rho c T + rho L clamp((T - T_low)/width, 0, 1)
struct PhaseChange {
  PhaseChange(const Filler& filler, const Melting& melting)
      : solid(filler.volumetric()),
        latent(filler.density * melting.latent_heat),
        low(melting.temperature - melting.width / 2),
        high(melting.temperature + melting.width / 2) {}

  double solid, latent, low, high;  // [J/(m^3 K)], [J/m^3], [K]

  /// Counted from T_low, so that no digits are lost [J/m^3].
  double heat(double t) const {
    const double sensible = solid * (t - low);
    if (t <= low) return sensible;
    return t >= high ? sensible + latent : sensible + latent * (t - low) / (high - low);
  }
  double temperature(double heat) const {
    if (heat <= 0) return low + heat / solid;
    const double full = solid * (high - low) + latent;
    return heat >= full ? low + (heat - latent) / solid : low + (high - low) * heat / full;
  }
  /// Apparent capacity dh/dT [J/(m^3 K)].
  double capacity(double t) const { return t > low && t < high ? solid + latent / (high - low) : solid; }
};

}  // namespace couplet::thermocline
