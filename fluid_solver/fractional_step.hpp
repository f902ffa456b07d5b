// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "fluid_solver/energy_guard.hpp"
#include "fluid_solver/immersed.hpp"
#include "fluid_solver/pressure.hpp"
#include "fluid_solver/rates.hpp"
#include "fluid_solver/state.hpp"
#include "fluid_solver/viscous_solver.hpp"

namespace couplet::fluid {

/// Where one sub-step goes.
template <int D>
struct SubStep {
  double dt = 0;                           ///< [s]
  std::shared_ptr<const Placement<D>> to;  ///< of the points at t^{n+1}
  std::vector<double> swept;               ///< dV_f per flux face [m^3]; empty: the mesh rests
  std::vector<Vec3> points;                ///< at t^{n+1}; empty: the mesh rests
  Vectors<D> rate{};                       ///< mean of R over the step; empty: by Adams-Bashforth
  Vectors<D> shear{};  ///< with `rate`: mean of the viscous force on the boundary faces [N]
};

struct StepStatistics {
  int pressure_iterations = 0, viscous_iterations = 0;
};

/// One step of the non-incremental projection method on a moving mesh, in three parts, so that a
/// semi-implicit coupling can repeat the middle one:
///   predict   V' u^p = V u^n + dt [(1 + r/2) R^n - r/2 R^{n-1}] + sum dV_f u_f~ - (dt/rho) sum p_f^{n-1/2}
///   (S^{n+1/2} - S^{n+1}) project   sum g (p_N - p_P) = (rho/dt) sum phi^p                      p =
///   p^{n+1/2} complete    phi = phi^p - (dt/rho) g dp,  u^{n+1} = u^p - dt/(rho V') sum p_f S^{n+1}
/// r = dt/dt_old; u~ = (1 + r/2) u^n - r/2 u^{n-1}; the thesis's (4.5)-(4.8) with its errata (density, sign
/// of diffusion).
template <int D>
class FractionalStep {
 public:
  /// `moving`: the mesh will move.
  FractionalStep(const Mesh& mesh, const Boundary<D>& boundary, const FluidParameters& parameters,
                 bool moving);

  /// `by`: how the step sees the level it starts from; `w`: given velocity per boundary face at t^{n+1}, as
  /// far as it is known. Collective.
  void predict(const State<D>& from, const History<D>& by, SubStep<D> step, const Vectors<D>& w);
  /// R of a state, explicit, and its viscous force on the boundary faces. Collective.
  void rates(const State<D>& of, Vectors<D>& rate, Vectors<D>& shear);
  /// May be called again with another w after one predict(). Collective.
  void project(const State<D>& from, const Vectors<D>& w);
  /// Makes level n+1 of the last project(), beside level n, and judges it. Throws SolveFailure naming time
  /// and place if its velocity is not finite. Collective.
  void complete(const State<D>& from);
  /// Puts level n+1 in the place of the level n it was made from, by swapping; makes it first if complete()
  /// was not called since the last project(). Cannot fail. Collective.
  void commit(State<D>& state);
  /// Makes the initial velocity divergence-free: state.u, w and u_boundary (u at the faces) are given, phi is
  /// filled.
  void project_initial(State<D>& state);

  /// The result of the last project() as a level of history. Collective.
  std::shared_ptr<PressureLevel<D>> pressure_level() const;
  /// Fills level.gradient from p and boundary. Collective.
  void set_gradient(const Placement<D>& at, PressureLevel<D>& level) const;
  /// Of the last project(), acting on what is outside the fluid [N]: +p_b S^{n+1/2} and the wall shear.
  const Vectors<D>& pressure_force() const { return pressure_force_; }
  const Vectors<D>& viscous_force() const { return viscous_force_; }
  /// state.eddy, if there is a turbulence model. Collective.
  void set_eddy_viscosity(State<D>& state);
  /// Null: none.
  const ImmersedBodies<D>* bodies() const { return bodies_.get(); }
  void refresh_solvers() { pressure_.refresh(); }
  const StepStatistics& statistics() const { return statistics_; }
  double size() const { return step_.dt; }
  /// Of the accepted steps [m/s].
  double largest_speed() const { return speed_scale_; }
  /// The mesh is not orthogonal, or may become so.
  bool oblique() const { return oblique_; }

 private:
  void solve_initial(const Placement<D>& at);
  void mark_bodies(double time);
  /// The placement as the pressure equation sees it: blocked faces conduct nothing.
  const Placement<D>& pressure_placement() const { return bodies_ ? *around_bodies_ : *step_.to; }
  void fill_pressure_in_bodies();
  void clear_bodies(std::vector<double>& values) const;
  void set_rates(const State<D>& from, bool implicit);
  void add_body_force();
  void add_swept(const State<D>& from, double e0, double e1);
  void add_old_pressure(const State<D>& from, bool implicit);
  double viscous_tolerance() const;
  void guess_velocity(const State<D>& from, double a);
  void solve_viscous(const State<D>& from, const Vectors<D>& w, double a);
  void solve_oblique_viscous(const Vectors<D>& w, double a);
  void add_back_old_pressure();
  void predict_flux(const State<D>& from);
  void set_relaxation(const State<D>& from);
  void add_memory(const State<D>& from);
  void add_increment(const State<D>& from);
  double pressure_excess(const State<D>& from, Index f) const;

  void extrapolate_pressure();
  void add_oblique_pressure();
  void solve_pressure(const State<D>& from, const Vectors<D>& w, double tolerance);
  void set_boundary_flux(const Vectors<D>& w);
  void balance_closed_domain();
  void set_boundary_pressure(const State<D>& from, const Vectors<D>& w);
  void extrapolate_to_walls();
  void set_forces(const State<D>& from);
  bool gradient_stands() const;
  void set_obliqueness(const Placement<D>& at);
  void remember_prediction(bool implicit);
  void correct_shear();
  void pressure_gradient(const Placement<D>& at, const std::vector<double>& p,
                         const std::vector<double>& boundary, Vectors<D>& sum) const;
  /// What a value linear between the cells lacks at a face of a skewed mesh.
  double skew_part(const Placement<D>& at, const Vectors<D>& gradient, Index f) const {
    const double w = at.weight[f];
    return (w * gradient[mesh_.owner[f]] + (1 - w) * gradient[mesh_.neighbour[f]]).dot(at.skew[f]);
  }
  std::shared_ptr<PressureLevel<D>> correct();
  void remember_flux(State<D>& state);
  struct Judgement {
    EnergyJudgement energy;
    double speed = 0;  // largest [m/s]; infinity where one is not finite
  };
  EnergyStep<D> energy_step(const State<D>& from) const;
  Judgement judge(const State<D>& from) const;
  void check(const State<D>& from);

  const Mesh& mesh_;
  const Boundary<D>& boundary_;
  const FluidParameters& parameters_;
  double rho_, nu_;
  bool oblique_ = false;       // the non-orthogonal parts are needed
  bool very_oblique_ = false;  // an implicit predictor needs them converged
  double degrees_ = 0;         // largest angle between a face's normal and the line of its cells
  RateOperator<D> rate_operator_;
  ViscousSolver<D> viscous_solver_;
  EnergyGuard<D> energy_guard_;
  PressureEquation<D> pressure_;
  std::shared_ptr<const Placement<D>> assembled_;  // placement of the pressure matrix

  std::unique_ptr<ImmersedBodies<D>> bodies_;          // null: none
  std::shared_ptr<const Placement<D>> around_bodies_;  // with bodies only
  std::vector<Expression> body_force_;
  Vectors<D> force_;  // f at t^{n+1/2} per local cell [m/s^2]; empty: none

  SubStep<D> step_;
  History<D> by_;                            // how the step sees its begin
  std::shared_ptr<PressureLevel<D>> level_;  // of level n+1; null: not made since the last project()
  Rates<D> rates_;
  Vectors<D> right_side_;  // of the predictor; u^{n+1} once that is made
  Vectors<D> u_p_, w_, u_boundary_, gradient_start_, gradient_guess_, shear_;
  Vectors<D> gradient_before_;  // very oblique meshes only
  Vectors<D> old_pressure_;     // dt/rho sum p^{n-1/2} S^{n+1}, of an implicit predictor on a moving mesh
  Vectors<D> oblique_rate_, viscous_side_, u_before_;
  std::vector<Tensor<D>> velocity_gradient_;  // skewed meshes only
  std::uint64_t gradient_of_ = 0;             // State::number whose gradient that is; 0: none's
  std::uint64_t states_ = 0;                  // numbered so far
  std::vector<double> relaxation_;            // [1/s]
  std::vector<double> fading_;                // incremental: of the start's delta, at t^{n+1}
  struct Fit {
    Tensor<D> matrix = Tensor<D>::Zero();
    Vec<D> side = Vec<D>::Zero();
    bool usable = false;
  };
  std::vector<Fit> fits_;          // of the cells at walls
  std::vector<Index> slot_;        // per local cell: which of the fits; -1: none
  std::vector<Index> near_walls_;  // interior faces of those cells
  std::vector<double> p_wall_;     // per boundary face, for the load [Pa]
  std::vector<double> phi_orthogonal_, phi_p_, b_, p_, p_boundary_;
  Vectors<D> pressure_force_, viscous_force_;
  StepStatistics statistics_;
  std::vector<Index> interface_faces_;        // boundary faces
  Vectors<D> w_predicted_, shear_predicted_;  // what the predictor took and gave there
  double shear_weight_ = 0;                   // of t^{n+1} in the mean shear
  Judgement judgement_;                       // of level_
  double speed_scale_ = 0;                    // largest of the accepted steps [m/s]
};

}  // namespace couplet::fluid
