// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <vector>

#include "common/base/types.hpp"
#include "common/parallel/collective.hpp"
#include "common/time/time_scheme.hpp"
#include "solid_solver/equilibrium/equilibrium.hpp"

namespace couplet::solid {

/// Energies of the solid since the start [J] (2-D: per meter of depth), summed over this rank. For a
/// trapezoidal step with loads and stress at mid-step, the energies balance to round-off:
///   kinetic - initial kinetic + internal work + damping loss + contact - initial contact = external work.
/// Other schemes dissipate the difference. The internal work of a nonsymmetric operator differs from the
/// change of strain energy; the difference measures how far the operator is from having a potential.
struct SolidEnergies {
  double kinetic = 0, initial_kinetic = 0;
  double strain = 0;         ///< sigma : epsilon / 2 at the accepted time
  double internal_work = 0;  ///< work of sigma (without damping) on the change of strain
  double external_work = 0;  ///< work of body forces, tractions and moving supports
  double damping_loss = 0;   ///< dissipated by Rayleigh damping
  bool conserving = true;    ///< trapezoidal rule, whose internal work is that of its own stress
  double contact = 0, initial_contact = 0;  ///< stored in the springs of a seat
  /// Energy dissipated by the scheme. A dissipative scheme uses the strain energy of the state, because the
  /// work of the end-of-step stress over the step exceeds the stored energy.
  double lost() const {
    return external_work + initial_kinetic - kinetic - (conserving ? internal_work : strain) - damping_loss +
           initial_contact - contact;
  }
};

/// State at one accepted time: `dim` values per local cell or boundary face (ghosts current).
struct SolidState {
  double time = 0, dt = 0;  ///< dt: size of the step that ended here
  int steps = 0;            ///< accepted so far
  std::vector<double> cell_u, cell_v, face_u, face_v;
  std::vector<double> known, known_rate;               ///< prescribed values, one per known column
  std::vector<double> cell_a;                          ///< generalized-alpha only
  std::vector<double> cell_u_old, cell_v_old;          ///< one step earlier; three-point rule
  std::vector<double> face_a, face_u_old, face_v_old;  ///< likewise at faces that have inertia
  std::vector<double> interface;    ///< partner's forces of the last step; generalized-alpha, three-point
  double stage_dt = 0;              ///< size of the last stage
  double offset_lag = 0;            ///< age of `offset` before `time`
  std::vector<double> offset;       ///< u_B - u_P of the traction faces at the place of the last stage
  std::vector<double> offset_rate;  ///< v_B - v_P at the middle of the last stage
  SolidEnergies energies;           ///< if requested
  double load_work = 0;             ///< work of the loads since the start, dynamic runs, this rank [J]
  double error = 0;                 ///< estimated for the last step if the step size is controlled, rms [m]
  // If the acceleration is requested: at `time` in cells and on faces, and its mean over the last step in cells.
  std::vector<double> acceleration, face_acceleration, mean_acceleration;
};

/// Cost of the solves in the last step.
struct SolverEffort {
  int solves = 0, iterations = 0, inner_iterations = 0;
  double residual = 0;  ///< norm of the last solve's residual
};

/// Stage of the current step, with all data that do not depend on the interface load.
struct StageWork {
  time::Stage stage;
  double damping_scale = 1;  ///< s = 1 + beta c
  SolidSystem* system = nullptr;
  double start_time = 0, place_time = 0, end_time = 0;
  /// Loads and prescribed displacements, without face forces and inertia; empty if there are none.
  std::vector<double> rhs;
  std::vector<double> known_force;  ///< contribution of the prescribed displacements to `rhs`; empty if none
  std::vector<double> known;        ///< prescribed w, one value per known column
  // If energies are requested: rows of body forces and effects, change of the prescribed displacements.
  std::vector<double> loads, known_change;
  std::vector<double> face_force;  ///< loads except the interface's, per boundary face of owned cells
};

/// Last solve: its rows and their loads; this rank's part.
struct LastSolve {
  /// In the rows of the operator; empty if nothing was solved since the start or a restart.
  std::vector<double> rhs;
  std::vector<double> unknowns;   ///< in the order of the operator
  std::vector<double> load_rows;  ///< without inertia and prescribed motion; for kernels with mass
  std::vector<double> interface;  ///< forces, `dim` values per boundary face of owned cells; may be empty
  std::vector<double> contact;    ///< forces of the seat on its faces [N]; empty if none
  Vec3 body_force = Vec3::Zero(), face_force = Vec3::Zero();  ///< sums
  /// True if something was solved since the start or a restart. Collective.
  bool is_known(MPI_Comm comm) const { return !parallel::any(comm, rhs.size() != unknowns.size()); }
};

}  // namespace couplet::solid
