// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <complex>

#include "common/time/time_scheme.hpp"

namespace couplet::time {

/// Rayleigh damping C = mass M + stiffness K.
struct RayleighCoefficients {
  double mass = 0;       ///< [1/s]
  double stiffness = 0;  ///< [s]
};

/// Largest factor by which a step of size dt multiplies free vibration in a mode of M^-1 K with this
/// eigenvalue [1/s^2]: the spectral radius of the scheme's step. A nonsymmetric K may have complex
/// eigenvalues.
double amplification(const TimeSchemeParameters& scheme, double dt, std::complex<double> eigenvalue,
                     const RayleighCoefficients& damping = {});

/// Exponential rate at which u'' = -eigenvalue u grows [1/s]: |Im sqrt(eigenvalue)|.
double growth_rate(std::complex<double> eigenvalue);
/// The same of the discrete step: ln(amplification) / dt [1/s].
double growth_rate(const TimeSchemeParameters& scheme, double dt, std::complex<double> eigenvalue,
                   const RayleighCoefficients& damping = {});

}  // namespace couplet::time
