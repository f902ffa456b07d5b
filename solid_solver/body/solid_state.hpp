// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "common/base/types.hpp"
#include "common/parallel/collective.hpp"
#include "common/time/time_scheme.hpp"
#include "solid_solver/equilibrium/equilibrium.hpp"

namespace couplet::solid {

/// Energies of the solid since the start [J] (2-D: per metre depth), each summed over this rank. With F the
/// loads and x_s the middle of a trapezoidal step, internal work and the others balance to round-off:
///   kinetic - initial kinetic + internal work + damping loss + contact - initial contact = external work.
/// The other schemes lose what is missing. The internal work of a nonsymmetric operator is not the
/// change of the strain energy; their difference shows how far it is from having a potential.
struct SolidEnergies {
  double kinetic = 0, initial_kinetic = 0;
  double strain = 0;         ///< sigma : epsilon / 2 at the accepted time
  double internal_work = 0;  ///< of sigma (without damping) on the change of strain
  double external_work = 0;  ///< of body forces, tractions and moving supports
  double damping_loss = 0;   ///< taken by Rayleigh damping
  bool conserving = true;    ///< the trapezoidal rule, whose internal work is that of its own stress
  double contact = 0, initial_contact = 0;  ///< kept in the springs of a seat
  /// By the scheme. Of a dissipative one what is missing in the state itself, its strain energy counted: the
  /// work of the stress at the end of a step on the change over it is more than what is stored.
  double lost() const {
    return external_work + initial_kinetic - kinetic - (conserving ? internal_work : strain) - damping_loss +
           initial_contact - contact;
  }
};

/// One accepted time: `dim` values a local cell or boundary face (ghosts up to date).
struct SolidState {
  double time = 0, dt = 0;  ///< dt: of the step that ended here
  int steps = 0;            ///< accepted so far
  std::vector<double> cell_u, cell_v, face_u, face_v;
  std::vector<double> known, known_rate;               ///< prescribed, one a known column
  std::vector<double> cell_a;                          ///< generalised-alpha alone
  std::vector<double> cell_u_old, cell_v_old;          ///< a step earlier; three-point, Adams's predictor
  std::vector<double> face_a, face_u_old, face_v_old;  ///< the same of faces, where they have inertia
  std::vector<double> interface;    ///< partner's forces of the last step; generalised-alpha, three-point
  double stage_dt = 0;              ///< of the last stage
  double offset_lag = 0;            ///< `offset` lives so long before `time`
  std::vector<double> offset;       ///< u_B - u_P of the traction faces where the last stage was solved
  std::vector<double> offset_rate;  ///< v_B - v_P at the middle of the last stage
  SolidEnergies energies;           ///< if they are wanted
  double load_work = 0;             ///< of the loads since the start, dynamic runs, this rank's [J]
  double error = 0;                 ///< estimated for the last step if the step size is controlled, rms [m]
  // If the acceleration is wanted: at `time`, in cells and on faces, and its mean over the last step in
  // cells.
  std::vector<double> acceleration, face_acceleration, mean_acceleration;
};

/// What the solves of the last step took.
struct SolverEffort {
  int solves = 0, iterations = 0, inner_iterations = 0;
  double residual = 0;  ///< norm of the last solve's
};

/// A stage of the step under way, with all that does not depend on the interface load.
struct StageWork {
  time::Stage stage;
  double damping_scale = 1;  ///< s = 1 + beta c
  SolidSystem* system = nullptr;
  double start_time = 0, place_time = 0, end_time = 0;
  std::vector<double> rhs;          ///< loads and prescribed displacements, without face forces and inertia;
                                    ///< empty: none
  std::vector<double> known_force;  ///< what `rhs` holds of the prescribed displacements; empty: none
  std::vector<double> known;        ///< prescribed w, one a known column
  // If energies are wanted: rows of body forces and effects, change of the prescribed displacements.
  std::vector<double> loads, known_change;
  std::vector<double> face_force;  ///< loads but the interface's, per boundary face of owned cells
};

/// The last solve: its rows and what loaded them; this rank's part.
struct LastSolve {
  std::vector<double>
      rhs;  ///< as the operator has its rows; empty: nothing solved since the start or a restart
  std::vector<double> unknowns;   ///< as the operator has them
  std::vector<double> load_rows;  ///< without inertia and prescribed motion; kernels with mass
  std::vector<double> interface;  ///< forces, `dim` values a boundary face of owned cells; empty: none
  std::vector<double> contact;    ///< forces of the seat on its faces [N]; empty: none, or nothing solved
  Vec3 body_force = Vec3::Zero(), face_force = Vec3::Zero();  ///< sums
  /// Something was solved since the start or a restart. Collective.
  bool is_known(MPI_Comm comm) const { return !parallel::any(comm, rhs.size() != unknowns.size()); }
};

}  // namespace couplet::solid
