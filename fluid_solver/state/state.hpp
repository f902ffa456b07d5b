// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "common/io/checkpoint.hpp"
#include "fluid_solver/state/placement.hpp"

namespace couplet::fluid {

/// Volume-integrated rates of change of u on a fixed mesh [m^4/s^2], per local cell (ghosts are undefined).
template <int D>
struct Rates {
  Vectors<D> rate;     ///< convection, and the viscous part if it is explicit
  Vectors<D> viscous;  ///< the viscous part if it is implicit, else empty
};

/// Projection pressure at the middle of its step.
template <int D>
struct PressureLevel {
  double time = 0;               ///< t^{n-1/2} [s]
  std::vector<double> p;         ///< per local cell [Pa]
  std::vector<double> boundary;  ///< p_b per boundary face [Pa]
  /// (1/V) sum p_f S per local cell [Pa/m]; only in the latest level (non-orthogonal meshes: two).
  Vectors<D> gradient;
  // Compressible fluids only.
  double upstream = 0;      ///< of the volume behind the inlets [Pa]
  std::vector<double> end;  ///< trapezoidal rule only: p at the end of the step, per local cell [Pa]
  double upstream_end = 0;  ///< likewise, of the volume [Pa]
  /// Sum of V dp/dt/(rho c^2) over this rank's cells at the end of the step [m^3/s]; not saved.
  double taken_up = 0;
};

/// Outflow beyond the given one at absorbing boundaries, per boundary face: phi/S of outlets and (w -
/// given).n of inlets [m/s], at t^n and t^{n-1}. Per absorbing patch its mean, or the mean pressure of an
/// inlet [Pa].
struct OpeningsState {
  std::vector<double> now, old, mean;
};

/// Start of a flow. A fluid at rest starts with an impulse, whose pressure does not predict later ones.
enum class Start : int { at_rest, after_impulse, flowing };

/// History of a level. A step may reinterpret it (another viscous treatment, a first pressure) without
/// changing the level itself until it is replaced.
template <int D>
struct History {
  double time = 0;        ///< t^n [s]
  double dt_old = 0;      ///< size of the last step [s]; 0: no history, the next step is an Euler step
  bool implicit = false;  ///< the history has an implicit viscous term (Rates::viscous)
  Start start = Start::flowing;
  /// Latest first; nullptr if there is none yet.
  std::array<std::shared_ptr<const PressureLevel<D>>, 3> pressure;
};

/// Kinetic energy and the part of it that no work explains, see EnergyGuard.
struct EnergyLedger {
  double energy = -1;    ///< at t^n [J]; negative if not known yet
  double largest = 0;    ///< so far [J]
  double excess = 0;     ///< [J]
  double reference = 0;  ///< recent scale for the excess [J]
  double level = 0;      ///< reference pressure for the work at boundaries [Pa]
  double work = 0;       ///< net work done so far [J]
  /// False if the energy is at round-off relative to the largest so far.
  bool is_judged() const { return energy > 1e-10 * largest && reference > 0; }
};

/// Complete input of the next step: level n and the history of the multi-step schemes.
template <int D>
struct State : History<D> {
  /// Identifies u among all computed states, to avoid recomputing derived data; 0 if not computed.
  std::uint64_t number = 0;
  EnergyLedger ledger;

  Vectors<D> u;           ///< u^n per local cell, ghosts current [m/s]
  Vectors<D> w;           ///< given velocity per boundary face at t^n [m/s]
  Vectors<D> u_boundary;  ///< closed boundary velocity at t^n [m/s]
  Vectors<D> turn;        ///< of the walls per boundary face at t^n, see turn_of() [m^2/s]; only with `turns`
  bool turns = false;     ///< the same on all ranks
  std::vector<double> phi;  ///< absolute volume flux per flux face at t^n [m^3/s]
  /// delta^n per interior face [m^3/s] (incremental: the rest of delta^0).
  std::vector<double> memory, memory_old;

  OpeningsState openings;  ///< empty without absorbing boundaries

  /// Cells in a closed gap, per local cell; nullptr if there are none.
  std::shared_ptr<const std::vector<char>> blocked;

  std::vector<double> eddy;  ///< eddy viscosity at t^n per local cell [m^2/s]; empty without a model

  Vectors<D> u_old, u_boundary_old;  ///< at t^{n-1}
  Rates<D> rates_old;                ///< at t^{n-1}
  Vectors<D> shear_old;              ///< viscous force on the boundary faces at t^{n-1} [N]

  std::shared_ptr<const Placement<D>> placement;  ///< of the points at t^n
  std::vector<Vec3> points;                       ///< moving mesh only
  std::vector<double> mesh_flux;                  ///< dV_f/dt of the last step [m^3/s], moving mesh only
};

/// End of one sub-step.
template <int D>
struct SubStep {
  double dt = 0;                           ///< [s]
  std::shared_ptr<const Placement<D>> to;  ///< of the points at t^{n+1}
  std::vector<double> swept;               ///< dV_f per flux face [m^3]; empty if the mesh is at rest
  std::vector<Vec3> points;                ///< at t^{n+1}; empty if the mesh is at rest
  Vectors<D> rate{};                       ///< mean of R over the step; empty with Adams-Bashforth
  Vectors<D> shear{};                      ///< with `rate`: mean viscous force on the boundary faces [N]
  bool yields = false;                     ///< walls of known mass respond to the pressure (Robin condition)
};

/// Sub-step and its view of level n, from which it starts. Constant until the next one.
template <int D>
struct Step : SubStep<D> {
  History<D> by;
  /// Pressure that the implicit predictor uses for this step; nullptr if there is none yet.
  std::shared_ptr<const PressureLevel<D>> guess = by.pressure[0];

  double begin() const { return by.time; }
  double middle() const { return by.time + this->dt / 2; }
  double end() const { return by.time + this->dt; }
  bool moving() const { return !this->swept.empty(); }
  /// Ratio of dt to the previous step; 0 if there is none.
  double ratio() const { return by.dt_old > 0 ? this->dt / by.dt_old : 0; }
};

/// Result of the prediction, the first stage of a step.
template <int D>
struct Prediction {
  Vectors<D> w;             ///< given velocities at t^{n+1} per boundary face, as far as known [m/s]
  Vectors<D> u;             ///< u^p per local cell [m/s]
  Vectors<D> force;         ///< f at t^{n+1/2} per local cell [m/s^2]; empty if there is none
  Vectors<D> viscous_flux;  ///< momentum flux to the surroundings, per boundary face [N]
  double weight = 0;        ///< weight of t^{n+1} in it; 0 with an explicit predictor
  Rates<D> rates;           ///< R^n
  Vectors<D> shear;         ///< viscous force on the boundary faces at t^n [N]
};

/// Result of the projection, the second stage.
template <int D>
struct Projected {
  std::vector<double> p, boundary;  ///< per local cell, per boundary face [Pa]
  std::vector<double> phi;          ///< phi^p per flux face, without the last pressure correction [m^3/s]
  Vectors<D> w;  ///< given velocities at t^{n+1}, including responses of walls and openings [m/s]
  /// Gradient of p in the non-orthogonal part, per local cell [Pa/m]; empty on orthogonal meshes.
  Vectors<D> gradient;
};

/// Writes a complete state, including history, bit for bit. Collective.
template <int D>
void write_state(io::CheckpointWriter& file, const State<D>& state, bool compressible = false);
/// `at_rest`: placement of a mesh at rest; nullptr if the file has the points. `compressible`: the file is of
/// such a fluid. Throws Error if the file does not fit the mesh. Collective.
template <int D>
State<D> read_state(io::CheckpointReader& file, const mesh::Mesh& mesh,
                    std::shared_ptr<const Placement<D>> at_rest, bool compressible = false);

}  // namespace couplet::fluid
