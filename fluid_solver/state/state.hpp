// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "fluid_solver/state/placement.hpp"

namespace couplet::fluid {

/// Volume-integrated rates of change of u on a mesh held still [m^4/s^2], per local cell (ghosts: not
/// meaningful).
template <int D>
struct Rates {
  Vectors<D> rate;     ///< convection, and the viscous part when it is treated explicitly
  Vectors<D> viscous;  ///< the viscous part when it is treated implicitly; else empty
};

/// One projection pressure. It lives at the middle of its step.
template <int D>
struct PressureLevel {
  double time = 0;               ///< t^{n-1/2} [s]
  std::vector<double> p;         ///< per local cell [Pa]
  std::vector<double> boundary;  ///< p_b per boundary face [Pa]
  Vectors<D> gradient;  ///< (1/V) sum p_f S per local cell [Pa/m]; the latest level only, on oblique meshes
                        ///< the latest two
  // Compressible fluids only.
  double upstream = 0;      ///< of the volume behind the inlets [Pa]
  std::vector<double> end;  ///< trapezoidal rule only: p at the end of the step, per local cell [Pa]
  double upstream_end = 0;  ///< likewise, of the volume [Pa]
  /// Sum of V dp/dt / (rho c^2) over this rank's cells at the end of the step [m^3/s]; not saved.
  double taken_up = 0;
};

/// At the absorbing boundaries, per boundary face: what leaves beyond what is given, phi/S of outlets and (w - given).n of
/// inlets [m/s], at t^n and t^{n-1}; per absorbing patch the mean of that, or of an inlet's pressure [Pa].
struct OpeningsState {
  std::vector<double> now, old, mean;
};

/// A fluid at rest is set going by the impulse of its first step, whose pressure says nothing of what comes.
enum class Start : int { at_rest, after_impulse, flowing };

/// How a level was reached: all that a step may look at in another way than the level was left (another
/// viscous treatment, a first pressure), so that the level itself stays as it is until it is replaced.
template <int D>
struct History {
  double time = 0;        ///< t^n [s]
  double dt_old = 0;      ///< size of the last step [s]; 0: no history, the next step is an Euler step
  bool implicit = false;  ///< viscous term of the history (Rates::viscous is there)
  Start start = Start::flowing;
  std::array<std::shared_ptr<const PressureLevel<D>>, 3>
      pressure;  ///< latest first; nullptr before it is there
};

/// Kinetic energy and what of it no work explains, see EnergyGuard.
struct EnergyLedger {
  double energy = -1;    ///< at t^n [J]; below 0: not known yet
  double largest = 0;    ///< so far [J]
  double excess = 0;     ///< [J]
  double reference = 0;  ///< by which the excess is measured: of late [J]
  double level = 0;      ///< pressure about which the boundaries' work is counted [Pa]
  double work = 0;       ///< brought in so far, less what was taken out [J]
  /// Below a share of the largest energy so far there is only round-off.
  bool is_judged() const { return energy > 1e-10 * largest && reference > 0; }
};

/// Everything that the next step needs: level n and the history of the multi-step schemes.
template <int D>
struct State : History<D> {
  std::uint64_t number = 0;  ///< of u among all that a solver computed, so that what follows from it is not
                             ///< computed again; 0: not computed
  EnergyLedger ledger;

  Vectors<D> u;           ///< u^n per local cell, ghosts current [m/s]
  Vectors<D> w;           ///< given velocity per boundary face at t^n [m/s]
  Vectors<D> u_boundary;  ///< closed boundary velocity at t^n [m/s]
  Vectors<D> turn;        ///< of the walls per boundary face at t^n, see turn_of() [m^2/s]; only with `turns`
  bool turns = false;     ///< the same on all ranks
  std::vector<double> phi;  ///< absolute volume flux per flux face at t^n [m^3/s]
  /// delta^n per interior face [m^3/s] (incremental: what is left of delta^0).
  std::vector<double> memory, memory_old;

  OpeningsState openings;  ///< empty without absorbing boundaries

  /// Per local cell, in a closed gap; nullptr if there is none.
  std::shared_ptr<const std::vector<char>> blocked;

  std::vector<double> eddy;  ///< eddy viscosity at t^n per local cell [m^2/s]; empty without a model

  Vectors<D> u_old, u_boundary_old;  ///< at t^{n-1}
  Rates<D> rates_old;                ///< at t^{n-1}
  Vectors<D> shear_old;              ///< viscous force on the boundary faces at t^{n-1} [N]

  std::shared_ptr<const Placement<D>> placement;  ///< of the points at t^n
  std::vector<Vec3> points;                       ///< moving mesh only
  std::vector<double> mesh_flux;                  ///< dV_f/dt of the last step [m^3/s], moving mesh only
};

}  // namespace couplet::fluid
