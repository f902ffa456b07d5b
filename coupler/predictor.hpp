// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

namespace couplet {

/// The coupling unknown: displacement at the structure's interface vertices, and the velocity that goes with
/// it. The velocity is not an unknown of its own: it undergoes the same linear combinations as the
/// displacement.
struct InterfaceState {
  std::vector<double> displacement, velocity;  ///< vertices x dim [m], [m/s]
};

/// What the predictor remembers of accepted steps.
struct InterfaceHistory {
  InterfaceState now;                ///< at t^n
  std::vector<double> old_velocity;  ///< at t^{n-1}; empty before the first step
  double old_dt = 0;                 ///< t^n - t^{n-1}
};

/// First guess for t^{n+1}, r = dt / old_dt (1 for constant steps):
///   order 0  eta* = eta^n                                               v* = v^n
///   order 1  eta* = eta^n + dt v^n                                      v* = v^n
///   order 2  eta* = eta^n + dt ((1 + r/2) v^n - r/2 v^{n-1})            v* = v^n + r (v^n - v^{n-1})
/// Without v^{n-1} order 2 is order 1.
InterfaceState predict(const InterfaceHistory& history, double dt, int order);

}  // namespace couplet
