// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "common/coupling/participant.hpp"
#include "common/parallel/collective.hpp"
#include "fluid_solver/boundary/boundary.hpp"
#include "fluid_solver/motion/scene.hpp"
#include "fluid_solver/step/fractional_step.hpp"
#include "fluid_solver/step/step_size.hpp"

namespace couplet::fluid {

struct FluidStatistics {
  int sub_steps = 0;  ///< of the last step
  long all_sub_steps = 0, pressure_iterations = 0, viscous_iterations = 0, pressure_solves = 0;
};

/// The fluid through whole coupling steps: cuts them into stable sub-steps, moves the mesh and the walls
/// linearly within them. The accepted state changes when the step is accepted only: a step that fails, is
/// repeated or begun again leaves nothing to be put back.
///
///   begin_step; prepare(points, w); solve_pressure(w') ...; accept
///
/// prepare() does all but the last pressure equation with the wall velocity w (predicted). solve_pressure(w')
/// then costs one pressure equation and may be repeated. The impulse of the added mass is exact for any
/// number of sub-steps: each contributes rho mu dw, and the dw add up to w'^{n+1} - w^n.
template <int D>
class Fluid {
 public:
  /// `geometry`: of the mesh at rest; of it the points alone are kept.
  Fluid(const mesh::Mesh& mesh, const mesh::Geometry& geometry, const FluidParameters& parameters,
        bool moving_mesh, double start_time = 0);

  void begin_step(double time, double dt);
  /// `points`: at t^{n+1}, empty if the mesh rests. `wall_velocity`: per boundary face at t^{n+1} [m/s], only
  /// the interface faces count; empty if they rest. Collective.
  void prepare(std::span<const Vec3> points, const Vectors<D>& wall_velocity);
  /// Before prepare() and solve_pressure(): the pressure that gave the interface its velocity, per boundary face [Pa].
  /// Walls of a known mass then answer to what the pressure differs from it (see yielding_walls.cpp).
  void yield_from(std::vector<double> load) {
    yields_ = boundary_.yields();
    boundary_.set_wall_load(std::move(load));
  }
  /// Before yield_from(): Boundary::set_wall_mass. Collective.
  void set_wall_mass(std::span<const Index> boundary_faces, std::span<const double> masses) {
    if (parallel::any(mesh_.comm, boundary_.set_wall_mass(boundary_faces, masses))) step_.forget_walls();
  }
  /// At the boundary faces, of the last solve_pressure() [Pa].
  const std::vector<double>& boundary_pressure() const { return step_.boundary_pressure(); }
  /// Before solve_pressure(): the turn of the interface's and the bodies' faces at the step's end, see turn_of();
  /// empty if they do not turn. Zero at the faces of other walls.
  void set_turn(Vectors<D> turn) { given_turn_ = std::move(turn); }
  /// Throws SolveFailure if the flow that follows is not valid; everything that can fail is here and in prepare().
  /// `answer`: PressureEquation::solve(), of a pass of a coupling that iterates.
  void solve_pressure(const Vectors<D>& wall_velocity, double answer = 0);
  /// Force that friction would add if it saw the wall velocity w instead of w*, that of prepare(),
  /// rho sqrt(nu dt) |w - w*| S / dt, over the load of the last solve_pressure() (less a uniform pressure),
  /// both as root mean square over the interface. Collective.
  double unseen_share(const Vectors<D>& w) const;
  /// Compares what all walls of a closed incompressible fluid have swept by these points: throws Error if they have changed its
  /// volume, beyond the error of faces that stand for curved walls. Sets the walls back along their normals by that error, unless
  /// a structure moves them. Collective.
  void keep_volume(std::vector<Vec3>& points, double time) const;
  /// prepare and solve_pressure.
  void solve(std::span<const Vec3> points, const Vectors<D>& wall_velocity);
  /// The step becomes level n. Cannot fail.
  void accept();

  const State<D>& state() const { return accepted_; }
  /// The pressure of the accepted state; nullptr before the first step. That of the state lacks the potential (see Scene).
  std::shared_ptr<const PressureLevel<D>> pressure() const;
  /// Placement at the end of the step that was prepared.
  const Placement<D>& end() const { return step_.to(); }
  /// For checkpoints: replaces the accepted state.
  void restore(State<D> state);
  /// For its save() and load(): what the solvers remember of earlier steps; load() comes after restore().
  FractionalStep<D>& solvers() { return step_; }
  /// Time means over the coupling step of the forces on what is outside, per boundary face [N].
  const Vectors<D>& pressure_force() const { return pressure_force_; }
  const Vectors<D>& viscous_force() const { return viscous_force_; }

  const Boundary<D>& boundary() const { return boundary_; }
  const mesh::Mesh& mesh() const { return mesh_; }
  /// Per local point, as read [m].
  const std::vector<Vec3>& points_at_rest() const { return path_.points_at_rest(); }
  const FluidParameters& parameters() const { return parameters_; }
  const FluidStatistics& statistics() const { return statistics_; }
  SubStepSize<D>& sizes() { return sizes_; }
  bool moving() const { return path_.moves(); }

  /// nullptr without immersed bodies.
  const ImmersedBodies<D>* bodies() const { return step_.bodies(); }
  /// nullptr if the order is second everywhere.
  const FourthOrder<D>* fourth() const { return step_.fourth(); }
  /// nullptr without gaps that may close.
  const Gaps<D>* gaps() const { return step_.gaps(); }

 private:
  /// State that the sub-step under way starts from.
  const State<D>& level() const { return split_ ? trial_ : accepted_; }
  void run_stages(SubStep<D>& step, double done, const Vectors<D>& wall_velocity);
  void start(const mesh::Geometry& geometry, double time);
  void check_wall_velocity() const;
  Vectors<D> wall_velocity_at(double done, const Vectors<D>& interface_velocity,
                              const SubStep<D>& step) const;
  void start_pressure(const SubStep<D>& step, const Vectors<D>& w);
  void add_forces(double share);
  void add_turning();

  const mesh::Mesh& mesh_;
  FluidParameters parameters_;
  MeshPath<D> path_;
  Boundary<D> boundary_;
  FractionalStep<D> step_;
  SubStepSize<D> sizes_;
  State<D> accepted_;    // level n: accept() and restore() alone change it
  History<D> begin_;     // how the step under way sees level n
  State<D> trial_;       // after the last finished sub-step of the step under way
  History<D> history_;   // how the sub-step under way sees level()
  bool split_ = false;   // a sub-step of the step under way is finished: it goes on from trial_
  bool judged_ = false;  // the prediction under way has given a sound level n+1
  bool yields_ = false;  // the walls, in the last sub-step
  double time_ = 0, dt_ = 0;
  Vectors<D> guess_;                         // given velocities at the step's end as prepare() had them
  Vectors<D> last_w_;                        // given velocities at the end of the last sub-step
  Vectors<D> pressure_done_, viscous_done_;  // time integrals over the finished sub-steps / dt_
  Vectors<D> pressure_force_, viscous_force_;
  Vectors<D> given_turn_, turn_;  // at the step's end: what set_turn() gave; of all walls. Empty: none
  FluidStatistics statistics_;
};

/// Resolves `surface: auto` of bodies. Throws Error if two bodies differ.
FluidParameters with_surfaces(FluidParameters parameters, bool moving);

/// Throws Error for effects that do not go together; where one leaves a single choice of another, sets it. `moving`: the
/// mesh will move. Collective.
template <int D>
void check_together(const mesh::Mesh& mesh, const Boundary<D>& boundary, FluidParameters& parameters,
                    bool moving);

/// An incompressible fluid without an outlet lets no wall move that would change its volume, unless something sets
/// its pressure level (`volume-level`). Throws Error for a fluid whose volume is trapped, or that asks for a level it
/// does not need. Collective.
template <int D>
void check_cavity(const Fluid<D>& fluid, coupling::Scheme scheme);

/// Shares by area of the interface's faces in the inflow of the given velocities at t^{n+1} and t^n [m^3/s], two values per face. Their
/// sums are the inflows. Collective.
template <int D>
std::vector<double> inflow_shares(const Fluid<D>& fluid, const std::vector<Index>& faces, double time,
                                  double dt);

}  // namespace couplet::fluid
