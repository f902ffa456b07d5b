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

/// Motion of a body in the reference configuration. A dynamic step runs through the stages of its time scheme
/// (common/time). In a stage, x is the displacement, v = c x + v_h the velocity and a = d x + a_h the
/// acceleration, with known v_h and a_h. With Rayleigh damping (2.79), w = x + beta v and s = 1 + beta c give
/// x = (w - beta v_h)/s. The equation is
///   rho V (d + alpha c) / s w - sum_f sigma(w) . S_f =
///       loads - rho V (a_h + alpha v_h - (d + alpha c) / s beta v_h).
/// The trapezoidal rule solves at mid-step, where the interface load is defined, so the coupled step is
/// second order. The other schemes use the interface load of the step in all stages. Traction faces have no
/// inertia. Their offset from the cell at n+1 is extrapolated from this stage and the last one, and never fed
/// back, so that it does not ring.
class SolidStepper final {
 public:
  /// Starts at rest or with the initial velocity. Keeps a reference to the body. Collective.
  explicit SolidStepper(SolidBody& body);

  /// The accepted state.
  const SolidState& state() const { return state_; }
  /// State at the end of the last solve(); after accept_step() the state before the accepted one.
  const SolidState& trial() const { return trial_; }
  /// Current or last step.
  const coupling::Step& step() const { return step_; }
  const SolidLedger& ledger() const { return ledger_; }
  const LastSolve& last_solve() const { return last_; }
  const SolverEffort& effort() const { return effort_; }
  /// Last method used; nullptr if there is none or large strain has its own.
  SolutionMethod* method() const { return systems_.empty() ? nullptr : systems_.front()->method.get(); }
  /// Largest step that the estimated error allows [s]; infinity if it is not controlled.
  double suggest_dt() const;

  /// Starts a step. If `has_loads`, the loads are current; otherwise prepare_loads() must precede solve().
  void begin_step(const coupling::Step& step, bool has_loads);
  /// Prepares effects, systems and right-hand sides of the stages. Collective.
  void prepare_loads();
  /// `interface_load`: forces, `dim` values per boundary face of owned cells, or empty. Throws SolveFailure.
  void solve(std::vector<double> interface_load);
  /// Accepts the current step. Cannot fail.
  void accept_step();
  /// Frees the solvers at the end of a static run, before its output, which needs memory.
  void release_solver();

  /// Saves or loads the accepted state. Collective.
  void visit(io::Archive& archive);
  /// First guesses affect results below the tolerance, so a restarted run uses the same ones. Call after the
  /// effects. Collective.
  void visit_guesses(io::Archive& archive);

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
  void add_face_forces(const StageWork& work);
  void guess(const StageWork& work, const SolidState& now);
  void finish_nodes(const StageWork& work, const SolidState& now);
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
  std::vector<std::unique_ptr<SolidSystem>> systems_;  // most recent first
  std::vector<StageWork> stages_;                      // of the current step
  std::string method_announced_;                       // last one written to the log
  SolidState state_, trial_;
  coupling::Step step_;
  SolverEffort effort_;
  LastSolve last_;
};

}  // namespace couplet::solid
