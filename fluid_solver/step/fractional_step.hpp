// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstdint>
#include <memory>
#include <vector>

#include "fluid_solver/heat/heat.hpp"
#include "fluid_solver/motion/obstacles.hpp"
#include "fluid_solver/motion/scene.hpp"
#include "fluid_solver/pressure/pressure.hpp"
#include "fluid_solver/step/stages.hpp"

namespace couplet::fluid {

/// Forces on the surroundings of the fluid, per boundary face [N], equal to the momentum flux of the fluid's
/// own equation through the wall. They are +p_b S^{n+1/2} with the wall pressure of the scheme, and the whole
/// viscous flux mu g (u_P - w) with its weights in time. An extrapolated pressure and the tangential flux
/// alone would differ from this by a splitting layer of first order in step and mesh size.
template <int D>
struct Loads {
  Vectors<D> pressure;  ///< pressure and the normal part of the viscous flux
  Vectors<D> viscous;   ///< tangential part of the viscous flux

  /// Sets the forces of a step from a level, after its projection.
  void set(const Scene<D>& scene, const FluidStep<D>& step, const Prediction<D>& prediction,
           const Projected<D>& projected, const State<D>& from);
};

// clang-format off
/// One step of the projection method on a moving mesh. It has three stages, so that a
/// semi-implicit coupling can repeat the second one. Each stage computes a result for the next one.
///   predict   V' u^p = V u^n + dt [(1 + r/2) R^n - r/2 R^{n-1}] + sum dV_f u_f~
///                      - (dt/rho) sum p_f^{n-1/2} (S^{n+1/2} - S^{n+1})                   Prediction, FaceFlux
///   project   sum g (p_N - p_P) = (rho/dt) sum phi^p,    p = p^{n+1/2}                    Projected, Loads
///   complete  phi = phi^p - (dt/rho) g dp,    u^{n+1} = u^p - dt/(rho V') sum p_f S^{n+1}
/// Here r = dt/dt_old and u~ = (1 + r/2) u^n - r/2 u^{n-1}. See (4.5)-(4.8) of the thesis with errata.
// clang-format on
template <int D>
class FractionalStep {
 public:
  /// `moving`: the mesh will move.
  FractionalStep(const mesh::Mesh& mesh, const std::vector<Vec3>& points_at_rest, const Boundary<D>& boundary,
                 const FluidParameters& parameters, bool moving);

  /// Switches to fourth order along the lines of a mesh at rest; `auto` does so if they cover half of it.
  /// Returns the placement to use. Collective.
  std::shared_ptr<const Placement<D>> raise_order(std::shared_ptr<const Placement<D>> at);
  /// nullptr if the order is second everywhere.
  const FourthOrder<D>* fourth() const { return scene_.fourth.get(); }

  /// `by`: how the step sees the level it starts from. `w`: given velocity per boundary face at t^{n+1}, as
  /// far as it is known. Collective.
  void predict(const State<D>& from, const FlowHistory<D>& by, SubStep<D> step, const Vectors<D>& w);
  /// May be called again with another w after one predict(). Collective.
  void project(const State<D>& from, const Vectors<D>& w, double answer = 0);
  /// Computes and checks level n+1 of the last project(), for the same w, beside level n. Where the splitting error asks for it, prediction
  /// and projection are repeated until they solve the coupled system of velocity and pressure. Throws SolveFailure with time and
  /// place if its velocity is not finite. Collective.
  void complete(const State<D>& from, const Vectors<D>& w);
  /// Replaces level n by level n+1 by swapping. Computes it first if complete() was not called since the last
  /// project(). Cannot fail. Collective.
  void commit(State<D>& state);
  /// True if the pressure is part of the state, not only the impulse of a step.
  bool pressure_is_state() const {
    return std::ranges::any_of(projection_.terms(), [](const auto& term) { return term->keeps_pressure(); });
  }
  /// Makes the initial velocity divergence-free. Reads state.u, w and u_boundary (u at the faces), sets phi.
  void project_initial(State<D>& state);
  /// Sets the data of the pressure terms in a state that no step computed. Collective.
  void start_terms(State<D>& state) const {
    for (const auto& term : projection_.terms()) term->start(state);
  }

  /// Sets state.blocked of a level that no step computed: the first one or one from a checkpoint. Collective.
  void mark_level(State<D>& state);
  /// nullptr if there are none.
  const Gaps<D>* gaps() const { return gaps_; }
  /// Returns the result of the last project() as a level of history. Collective.
  std::shared_ptr<PressureLevel<D>> pressure_level() const { return projection_.pressure_level(); }
  /// Fills the data that follow from p and boundary in a level that no step computed. Collective.
  void start_level(const Placement<D>& at, PressureLevel<D>& level) const { projection_.start(at, level); }
  /// Forces on the surroundings after the last project() [N], see Loads.
  const Vectors<D>& pressure_force() const { return loads_.pressure; }
  const Vectors<D>& viscous_force() const { return loads_.viscous; }
  /// Sets the data of the momentum terms in a new state. Collective.
  void start_momentum(State<D>& state) {
    for (const auto& term : momentum_terms()) term->start(state);
  }
  /// nullptr if the temperature is not computed.
  HeatTransport<D>* heat() const { return heat_.get(); }
  /// A step of the temperature alone, on a mesh at rest.
  void predict_heat(const State<D>& from, const FlowHistory<D>& by, SubStep<D> step);
  void commit_heat(State<D>& s);
  const MomentumTerms<D>& momentum_terms() { return predictor_.rate_operator().terms(); }
  /// nullptr if there are none.
  const ImmersedBodies<D>* bodies() const { return bodies_; }
  const Scene<D>& scene() const { return scene_; }
  /// Pressure of the last project() per boundary face [Pa].
  const std::vector<double>& boundary_pressure() const { return projected_.boundary; }
  /// State of the solvers in addition to the level, as of the last keep(). load() is collective.
  void keep() { projection_.accept(); }
  void save(io::CheckpointWriter& file) const { projection_.save(file); }
  void load(io::CheckpointReader& file) { projection_.load(file); }
  /// Iterations of the linear solvers so far.
  int pressure_iterations() const { return projection_.iterations(); }
  int viscous_iterations() const { return predictor_.iterations(); }
  double size() const { return step_.dt; }
  /// Placement at the end of the step.
  const Placement<D>& to() const { return *step_.to; }
  /// Points at the end of the step; empty if the mesh is at rest.
  const std::vector<Vec3>& points() const { return step_.points; }
  /// True if the mesh is not orthogonal or may become so.
  bool oblique() const { return scene_.oblique; }

 private:
  void predict_from_guess(const State<D>& from);
  std::shared_ptr<PressureLevel<D>> correct();
  struct Outcome {
    EnergyChange energy;
    double speed = 0;        // largest [m/s]; infinity if one is not finite
    double given_speed = 0;  // largest at the boundaries [m/s]
  };
  void solve_coupled(const State<D>& from, const Vectors<D>& w);
  void project_from_guess(const State<D>& from, const Vectors<D>& w);
  Vectors<D> friction_of(const Vectors<D>& x) const;
  double splitting_error(const PressureLevel<D>& now, double enough);
  EnergyStep<D> energy_step(const State<D>& from) const;
  Outcome evaluate(const State<D>& from) const;
  bool too_fast(double so_far) const;
  void check(const State<D>& from);
  void keep_initial(State<D>& state);
  void mark(double time);

  const mesh::Mesh& mesh_;
  Scene<D> scene_;
  FluidStep<D> step_;
  Prediction<D> prediction_;
  Projected<D> projected_;
  KnownGradient<D> gradient_;
  const ImmersedBodies<D>* bodies_ = nullptr;  // owned by the scene as obstacles; nullptr if there are none
  const Gaps<D>* gaps_ = nullptr;              // likewise
  std::unique_ptr<HeatTransport<D>> heat_;     // nullptr without heat
  Predictor<D> predictor_;
  FaceFlux<D> flux_;
  PressureProjection<D> projection_;
  Loads<D> loads_;
  EnergyCheck<D> energy_check_;
  Vectors<D> u_;                             // u^{n+1} with level_
  std::shared_ptr<PressureLevel<D>> level_;  // of level n+1; nullptr after project()
  Outcome judgement_;                        // of level_
  std::uint64_t states_ = 0;                 // number of states so far
};

}  // namespace couplet::fluid
