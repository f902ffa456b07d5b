// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <complex>
#include <string>
#include <vector>

#include "common/config/section.hpp"

namespace couplet::time {

/// `automatic` lets the equation choose; it then passes one of the others to the functions below.
enum class TimeScheme { automatic, euler, three_point, trapezoidal, bathe, generalised_alpha };

struct TimeSchemeParameters {
  TimeScheme type = TimeScheme::trapezoidal;
  double spectral_radius = 0.8;  // of generalised-alpha: amplification of the highest modes per step
};

/// Declares the keys of `time-scheme` for second-order equations. `automatic` documents the choice of `auto`;
/// if it is empty, `auto` is not allowed.
void declare(config::Section& section, TimeSchemeParameters& parameters, const std::string& automatic = "");

/// Linear combination of the values known in a stage: its unknown x (a value within the stage), value, rate
/// and acceleration at its start, and value and rate one level further back.
struct Levels {
  double x = 0, u = 0, v = 0, a = 0, u_old = 0, v_old = 0;

  friend Levels operator+(const Levels& p, const Levels& q) {
    return {p.x + q.x, p.u + q.u, p.v + q.v, p.a + q.a, p.u_old + q.u_old, p.v_old + q.v_old};
  }
  friend Levels operator*(double s, const Levels& p) {
    return {s * p.x, s * p.u, s * p.v, s * p.a, s * p.u_old, s * p.v_old};
  }
  friend Levels operator-(const Levels& p, const Levels& q) { return p + -1.0 * q; }
};

/// One implicit solve. Equilibrium holds at t + place * dt, where the value is the unknown x, and rate and
/// acceleration are these combinations. The end values follow from it.
struct Stage {
  double start = 0;  ///< after the start of the step [s]
  double dt = 0;     ///< length of the stage [s]
  double place = 1;  ///< of the unknown and the loads: 1/2 at the middle of the stage, 1 at its end
  Levels rate{}, acceleration{};
  Levels end_value{}, end_rate{}, end_acceleration{};
  /// True if the acceleration belongs to the end of the stage, false if it is the mean over it (trapezoidal
  /// rule).
  bool acceleration_at_end = true;
};

/// Previous steps of the run.
struct StepHistory {
  int steps = 0;      ///< accepted so far; 0 if there is no previous level
  double dt_old = 0;  ///< length of the last step [s]
};

/// Stages of a step for M u'' + C u' + K u = F:
///   euler             backward, thesis (2.44)
///   three-point       backward with variable steps, thesis (2.46)-(2.47)
///   trapezoidal       thesis (2.45) with its erratum, as the mid-point rule: x at t + dt/2, u^{n+1} = 2x - u^n
///   bathe             trapezoidal over (2 - sqrt 2) dt, then three-point over the rest: both have the same matrix
///   generalised-alpha [chung1993], the acceleration is part of the state
/// The first step of three-point and generalised-alpha, which need more than the initial values, is a
/// trapezoidal one. The functions below state if a scheme uses u_old, v_old or a.
std::vector<Stage> second_order_stages(const TimeSchemeParameters& scheme, double dt,
                                       const StepHistory& history);

/// Returns true if the scheme needs the level before the last one at the start of a step.
bool uses_old_level(TimeScheme scheme);
/// Returns true if the scheme needs the acceleration at the start of a step.
bool uses_acceleration(TimeScheme scheme);

/// Local error of a step: constant * dt^(order + 1) * the (order + 1)-th derivative of the value.
struct LocalError {
  int order = 2;
  double constant = 0;
};
LocalError local_error(const TimeSchemeParameters& scheme);

std::string name(TimeScheme scheme);

/// Rayleigh damping C = mass M + stiffness K.
struct RayleighCoefficients {
  double mass = 0;       ///< [1/s]
  double stiffness = 0;  ///< [s]
};

/// Spectral radius of the scheme: largest factor by which a step dt multiplies free vibration in a mode of
/// M^-1 K with this eigenvalue [1/s^2]. A nonsymmetric K may have complex eigenvalues.
double amplification(const TimeSchemeParameters& scheme, double dt, std::complex<double> eigenvalue,
                     const RayleighCoefficients& damping = {});

/// Exponential growth rate of u'' = -eigenvalue u [1/s]: |Im sqrt(eigenvalue)|.
double growth_rate(std::complex<double> eigenvalue);
/// Growth rate of the discrete step: ln(amplification) / dt [1/s].
double growth_rate(const TimeSchemeParameters& scheme, double dt, std::complex<double> eigenvalue,
                   const RayleighCoefficients& damping = {});

}  // namespace couplet::time
