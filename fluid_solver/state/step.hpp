// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <vector>

#include "fluid_solver/state/state.hpp"

namespace couplet::fluid {

/// Where one sub-step goes.
template <int D>
struct SubStep {
  double dt = 0;                           ///< [s]
  std::shared_ptr<const Placement<D>> to;  ///< of the points at t^{n+1}
  std::vector<double> swept;               ///< dV_f per flux face [m^3]; empty if the mesh is at rest
  std::vector<Vec3> points;                ///< at t^{n+1}; empty if the mesh is at rest
  Vectors<D> rate{};                       ///< mean of R over the step; empty with Adams-Bashforth
  Vectors<D> shear{};                      ///< with `rate`: mean viscous force on the boundary faces [N]
  bool yields = false;                     ///< walls of known mass answer to the pressure (Robin condition)
};

/// A sub-step and how it sees the level n that it starts from. It stays as it is until the next one.
template <int D>
struct Step : SubStep<D> {
  History<D> by;

  double begin() const { return by.time; }
  double middle() const { return by.time + this->dt / 2; }
  double end() const { return by.time + this->dt; }
  bool moving() const { return !this->swept.empty(); }
  /// dt over that of the step before; 0 if there is none.
  double ratio() const { return by.dt_old > 0 ? this->dt / by.dt_old : 0; }
};

/// Result of the prediction, the first stage of a step.
template <int D>
struct Prediction {
  Vectors<D> w;             ///< given velocities at t^{n+1} per boundary face, as far as they are known [m/s]
  Vectors<D> u;             ///< u^p per local cell [m/s]
  Vectors<D> force;         ///< f at t^{n+1/2} per local cell [m/s^2]; empty if there is none
  Vectors<D> viscous_flux;  ///< of momentum on what is outside, per boundary face [N]
  double weight = 0;        ///< of t^{n+1} in it; 0 with an explicit predictor
  Rates<D> rates;           ///< R^n
  Vectors<D> shear;         ///< viscous force on the boundary faces at t^n [N]
};

/// Result of the projection, the second stage: p = p^{n+1/2} and what belongs to it.
template <int D>
struct Projected {
  std::vector<double> p, boundary;  ///< per local cell, per boundary face [Pa]
  std::vector<double> phi;  ///< phi^p per flux face, the last pressure's part still to be added [m^3/s]
  Vectors<D> w;             ///< given velocities at t^{n+1}, answers of walls and openings included [m/s]
  /// Gradient of p in the non-orthogonal part, per local cell [Pa/m]; empty on orthogonal meshes.
  Vectors<D> gradient;
};

}  // namespace couplet::fluid
