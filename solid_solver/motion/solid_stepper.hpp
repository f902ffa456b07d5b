// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "common/coupling/participant.hpp"
#include "common/time/time_scheme.hpp"
#include "solid_solver/body/solid_body.hpp"
#include "solid_solver/body/solid_state.hpp"
#include "solid_solver/motion/ledger.hpp"

namespace couplet::solid {

/// The motion of a body in the reference configuration. A dynamic step runs through the stages of its time
/// scheme (common/time). At the place of a stage x is the displacement, v = c x + v_h the velocity and
/// a = d x + a_h the acceleration, v_h and a_h being known. With Rayleigh damping (2.79), w = x + beta v and
/// s = 1 + beta c, hence x = (w - beta v_h) / s, what is solved is
///   rho V (d + alpha c) / s w - sum_f sigma(w) . S_f =
///       loads - rho V (a_h + alpha v_h - (d + alpha c) / s beta v_h).
/// The trapezoidal rule solves in the middle of the step, where the interface load lives, which keeps the
/// coupled step second order. The other schemes take the interface load of the step in all their stages.
/// Traction faces have no inertia: at n+1 their offset from the cell is extrapolated from the places of this
/// stage and the last one, never fed back into the solution, so that they do not ring.
class SolidStepper final {
 public:
  /// At rest, or with the initial velocity. The body by reference. Collective.
  explicit SolidStepper(SolidBody& body);

  /// The accepted state.
  const SolidState& state() const { return state_; }
  /// State at the end of the last solve(); after accept_step() the state before the accepted one.
  const SolidState& trial() const { return trial_; }
  /// The step under way, or the last one.
  const coupling::Step& step() const { return step_; }
  const SolidLedger& ledger() const { return ledger_; }
  const LastSolve& last_solve() const { return last_; }
  const SolverEffort& effort() const { return effort_; }
  /// What solved last; null: nothing has, or large strain by itself.
  SolutionMethod* method() const { return systems_.empty() ? nullptr : systems_.front()->method.get(); }
  /// Largest step that the estimated error allows [s]; infinity if it is not controlled.
  double suggest_dt() const;

  /// A step is tried; its loads are those at hand if `has_loads`, else prepare_loads() follows before solve().
  void begin_step(const coupling::Step& step, bool has_loads);
  /// Effects, systems and right-hand sides of the stages. Collective.
  void prepare_loads();
  /// `interface_load`: forces, `dim` values a boundary face of owned cells; empty: none. Throws SolveFailure.
  void solve(std::vector<double> interface_load);
  /// What was tried is the state now. Cannot fail.
  void accept_step();
  /// Frees what solves if nothing is solved any more: at the end of a static run, before its files, which need room.
  void release_solver();

  void save_state(io::CheckpointWriter& file) const;
  void load_state(io::CheckpointReader& file);
  /// First guesses decide what is left below the tolerance: a run that continues makes the same ones. Loading
  /// comes after that of the effects.
  void save_guesses(io::CheckpointWriter& file) const;
  void load_guesses(io::CheckpointReader& file);

 private:
  void start_from_rest();
  void apply_stiffness();
  std::vector<time::Stage> stages_of(double dt) const;
  SolidSystem& system_for(double mass_factor);
  SolidProblem problem_of(const SolidSystem& system) const;
  void announce(const SolidSystem& system);
  void announce_time_scheme() const;
  void prepare_stage(StageWork& work);
  void subtract_prescribed(StageWork& work);
  void add_body_forces(double t, std::span<double> rhs);
  void solve_stage(const StageWork& work, bool first);
  linalg::SolveStatistics find_equilibrium(const StageWork& work, const SolidState& now);
  void scale_loads(const StageWork& work, double factor);
  void add_inertia(const StageWork& work, const SolidState& now);
  void add_kernel_inertia(const StageWork& work, const SolidState& now, const time::Levels& known);
  void add_face_forces(const StageWork& work);
  void guess(const StageWork& work, const SolidState& now);
  void finish_cells(const StageWork& work, const SolidState& now);
  void finish_faces(const StageWork& work, const SolidState& now);
  void finish_offsets(const time::Stage& stage, const SolidState& now);
  void finish_acceleration();
  void update_trial_ghosts();
  void judge_step();

  SolidBody& body_;
  const mesh::Mesh& mesh_;
  const mesh::Geometry& geometry_;
  const SolidParameters& parameters_;
  const elastic::ElasticOperator& elastic_;
  const elastic::ElasticKernel& kernel_;
  const SolidLedger ledger_;
  std::vector<std::unique_ptr<SolidSystem>> systems_;  // those used last, latest first
  std::vector<StageWork> stages_;                      // of the step under way
  std::string method_announced_;                       // what the log said last
  SolidState state_, trial_;
  coupling::Step step_;
  SolverEffort effort_;
  LastSolve last_;
};

}  // namespace couplet::solid
