// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <mpi.h>

#include <array>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "common/coupling/participant.hpp"
#include "common/parallel/collective.hpp"
#include "fluid_solver/boundary/boundary.hpp"
#include "fluid_solver/motion/scene.hpp"
#include "fluid_solver/state/state.hpp"
#include "fluid_solver/step/fractional_step.hpp"
#include "fluid_solver/step/step_size.hpp"

namespace couplet::fluid {

/// Decides when a semi-implicit step repeats its prediction, and with which wall velocity. Friction uses the
/// guessed wall velocity w*, which acts like an unseen mass E beside the mass M of the loop. Repeated
/// predictions are a fixed-point iteration g -> w(g) with contraction E/M, relaxed by Aitken's factor from
/// the second one on.
template <int D>
class Renewal {
 public:
  /// Starts the first pass of a step, whose prediction uses w.
  void start(const Vectors<D>& w);
  /// Takes a further pass with w. `unseen`: friction force due to w - guess(), relative to the load
  /// less a uniform pressure; `of_all`: to all of it. Returns
  /// true if the prediction must be repeated with guess(). Throws SolveFailure if it was
  /// repeated often and still misses too much. Collective.
  bool wanted(MPI_Comm comm, const Vectors<D>& w, double unseen, double of_all = 1);
  const Vectors<D>& guess() const { return guess_; }
  int count() const { return count_; }

 private:
  bool is_good(MPI_Comm comm, const Vectors<D>& w) const;
  void move_guess(MPI_Comm comm, const Vectors<D>& w);

  Vectors<D> guess_, gap_;  // gap_: w - guess at the last renewal
  double factor_ = 1;
  int passes_ = 0;  // with the current prediction
  int count_ = 0;   // renewals in the step
};

struct FluidStatistics {
  int sub_steps = 0;  ///< of the last step
  long all_sub_steps = 0, pressure_iterations = 0, viscous_iterations = 0, pressure_solves = 0;
};

/// Advances the fluid by whole coupling steps. Cuts each into stable sub-steps, within which mesh and walls
/// move linearly. The accepted state changes only in accept(), so a failed or repeated step needs no
/// rollback.
///
///   begin_step; prepare(points, w); solve_pressure(w') ...; accept
///
/// prepare() does all but the last pressure equation, with the predicted wall velocity w. solve_pressure(w')
/// solves that equation and may be repeated. The impulse of the added mass is exact for any number of
/// sub-steps: each contributes rho mu dw, and the dw add up to w'^{n+1} - w^n.
template <int D>
class Fluid {
 public:
  /// `geometry`: geometry of the mesh at rest; only its points are kept.
  Fluid(const mesh::Mesh& mesh, const mesh::Geometry& geometry, const FluidParameters& parameters,
        bool moving_mesh, double start_time = 0);

  void begin_step(double time, double dt);
  /// `points`: positions at t^{n+1}, empty if the mesh is at rest. `wall_velocity`: velocity of each boundary face at t^{n+1}
  /// [m/s], read only at interface faces; empty if they are at rest. Collective.
  void prepare(std::span<const Vec3> points, const Vectors<D>& wall_velocity);
  /// Sets the pressure that gave the interface its velocity, per boundary face [Pa]. Walls of known mass then
  /// respond to the change of pressure (see wall_terms.cpp). Call before prepare() and solve_pressure().
  void yield_from(std::vector<double> load) {
    yields_ = boundary_.yields();
    boundary_.set_wall_load(std::move(load));
  }
  /// Pressure at the boundary faces from the last solve_pressure() [Pa].
  const std::vector<double>& boundary_pressure() const { return step_.boundary_pressure(); }
  /// The temperature, or nullptr without heat. A film is set before prepare() or repeat_heat().
  HeatTransport<D>* heat() { return step_.heat(); }
  /// Computes the temperature of the last sub-step again, for another film. Call after prepare().
  void repeat_heat() { step_.heat()->advance(level()); }
  /// Sets the turn (see turn_of()) of interface and body faces at the end of the step; zero at other walls.
  /// Empty if they do not rotate. Call before solve_pressure().
  void set_turn(Vectors<D> turn) { given_turn_ = std::move(turn); }
  /// Throws SolveFailure if the resulting flow is not valid. Only this function and prepare() can fail.
  /// `answer`: see PressureEquation::solve(); used in the passes of an iterative coupling.
  void solve_pressure(const Vectors<D>& wall_velocity, double answer = 0);
  /// Change of the friction force if it used the wall velocity w instead of w* of prepare(): rho sqrt(nu dt)
  /// |w - w*| S/dt, relative to the load of the last solve_pressure() less a uniform pressure, and to all of it. These are root
  /// mean squares over the interface. Collective.
  std::array<double, 2> unseen_share(const Vectors<D>& w) const;
  /// prepare and solve_pressure.
  void solve(std::span<const Vec3> points, const Vectors<D>& wall_velocity);
  /// Makes the step level n. Cannot fail.
  void accept();

  const State<D>& state() const { return accepted_; }
  /// The pressure of the accepted state; nullptr before the first step. That of the state lacks the potential (see Scene).
  std::shared_ptr<const PressureLevel<D>> pressure() const;
  /// Placement at the end of the prepared step.
  const Placement<D>& end() const { return step_.to(); }
  /// Replaces the accepted state, for checkpoints.
  void restore(State<D> state);
  /// Memory of the solvers, for save() and load(). Call load() after restore().
  FractionalStep<D>& solvers() { return step_; }
  /// Time means over the coupling step of the forces on the surroundings, per boundary face [N].
  const Vectors<D>& pressure_force() const { return pressure_force_; }
  const Vectors<D>& viscous_force() const { return viscous_force_; }

  const Boundary<D>& boundary() const { return boundary_; }
  const mesh::Mesh& mesh() const { return mesh_; }
  /// Per local point, as read [m].
  const std::vector<Vec3>& points_at_rest() const { return path_.points_at_rest(); }
  const FluidParameters& parameters() const { return parameters_; }
  const Properties& properties() const { return step_.scene().fluid; }
  const FluidStatistics& statistics() const { return statistics_; }
  SubStepSize<D>& sizes() { return sizes_; }
  bool moving() const { return path_.moves(); }

  /// nullptr if there are no immersed bodies.
  const ImmersedBodies<D>* bodies() const { return step_.bodies(); }
  /// nullptr if the order is second everywhere.
  const FourthOrder<D>* fourth() const { return step_.fourth(); }
  /// nullptr if there are no gaps that may close.
  const Gaps<D>* gaps() const { return step_.gaps(); }

 private:
  /// State from which the current sub-step starts.
  const State<D>& level() const { return split_ ? trial_ : accepted_; }
  void start(const mesh::Geometry& geometry, double time);
  void check_wall_velocity() const;
  std::optional<State<D>> moved_by_boundaries() const;
  Vectors<D> wall_velocity_at(double done, const Vectors<D>& interface_velocity,
                              const SubStep<D>& step) const;
  void start_pressure(const SubStep<D>& step, const Vectors<D>& w);
  void add_forces(double share);
  Vectors<D> wall_turn(double time) const;
  void set_turn_of(State<D>& state, Vectors<D>& turn) const;
  void add_turning();

  const mesh::Mesh& mesh_;
  FluidParameters parameters_;
  MeshPath<D> path_;
  Boundary<D> boundary_;
  FractionalStep<D> step_;
  SubStepSize<D> sizes_;
  State<D> accepted_;       // level n: only accept() and restore() change it
  FlowHistory<D> begin_;    // how the current step sees level n
  State<D> trial_;          // after the last finished sub-step of the current step
  FlowHistory<D> history_;  // how the current sub-step sees level()
  bool frozen_ = false;     // the current step only computes the temperature
  bool split_ = false;      // a sub-step of the current step is finished; the next starts from trial_
  bool rejected_ = false;   // a longer step from here was rejected: what led to it is no measure of the flow
  bool judged_ = false;     // the current prediction has given a valid level n+1
  bool yields_ = false;     // walls respond to the pressure in the last sub-step
  double time_ = 0, dt_ = 0;
  Vectors<D> guess_;                         // given velocities at the end of the step, from prepare()
  Vectors<D> last_w_;                        // given velocities at the end of the last sub-step
  Vectors<D> pressure_done_, viscous_done_;  // time integrals over the finished sub-steps / dt_
  Vectors<D> pressure_force_, viscous_force_;
  // At the end of the step: from set_turn(), and of all walls. Empty if none rotates.
  Vectors<D> given_turn_, turn_;
  FluidStatistics statistics_;
};

/// Throws Error for incompatible effects. Where one effect leaves a single choice for another, sets it.
/// `moving`: the mesh will move. Collective.
template <int D>
void check_together(const mesh::Mesh& mesh, const Boundary<D>& boundary, FluidParameters& parameters,
                    bool moving);

}  // namespace couplet::fluid
