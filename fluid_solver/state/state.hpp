// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "common/io/checkpoint.hpp"
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

/// All of a state, history included, bit for bit. Collective.
template <int D>
void write_state(io::CheckpointWriter& file, const State<D>& state, bool compressible = false);
/// `at_rest`: the placement of a mesh that does not move; nullptr if the file says where the points are. `compressible`: the file
/// is that of such a fluid. Throws Error if the file does not fit the mesh. Collective.
template <int D>
State<D> read_state(io::CheckpointReader& file, const mesh::Mesh& mesh,
                    std::shared_ptr<const Placement<D>> at_rest, bool compressible = false);

}  // namespace couplet::fluid
