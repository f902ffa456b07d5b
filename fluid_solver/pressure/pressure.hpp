// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <memory>
#include <span>
#include <vector>

#include "common/io/checkpoint.hpp"
#include "common/linalg/acceleration.hpp"
#include "common/linalg/cell_solver.hpp"
#include "fluid_solver/boundary/boundary.hpp"
#include "fluid_solver/motion/scene.hpp"
#include "fluid_solver/state/state.hpp"

namespace couplet::fluid {

/// Additions to the diagonal; an empty vector adds nothing.
struct Diagonal {
  std::vector<double> faces;  ///< per boundary face [m]
  std::vector<double> cells;  ///< per owned cell [m]
};

/// A = -sum_f g (p_N - p_P), plus g p_P at faces of given pressure: symmetric, positive (semi-)definite.
/// Faces of given flux have no entry. The sparsity is fixed; a moved mesh only changes the values.
template <int D>
class PressureEquation {
 public:
  /// `fixed`: the mesh is at rest, so nothing is kept for a second set().
  PressureEquation(const mesh::Mesh& mesh, const Boundary<D>& boundary, bool fixed);
  /// `regular`: the additions determine the level in a closed domain. Collective.
  void set(const Placement<D>& at, bool regular = false, const Diagonal& added = {});
  /// True if the pressure is determined only up to a constant.
  bool singular() const { return boundary_.closed() && !regular_; }
  /// Saves the matrix from which the preconditioner was made, so that it can be rebuilt. A fixed matrix needs
  /// no saving.
  void save(io::CheckpointWriter& file) const;
  /// Makes the present state the one that save() saves.
  void accept() { accepted_ = now_; }
  /// Restores the matrix of the preconditioner: call set() before the next solve. Collective.
  void load(io::CheckpointReader& file);
  /// Rebuilds the preconditioner at the next solve.
  void refresh() {
    if (solver_) solver_->solver().refresh();
  }
  /// `b`: right-hand side per owned cell, made compatible here in a closed domain. `p`: pressure per local cell, a guess on
  /// entry; on exit it has current ghosts, and zero mean in a closed domain (at its convective outlets, if any). Stops at
  /// max(relative |b|, absolute). `answer` also reduces the residual of the guess to this share, down to
  /// least_answer relative |b|, so that a partner that changes b sees the response of p. `size`: replaces |b|
  /// unless negative. Collective.
  linalg::SolveStatistics solve(const Placement<D>& at, std::vector<double>& b, std::vector<double>& p,
                                double relative, double absolute, double answer = 0, double size = -1);
  static constexpr double least_answer = 1e-4;
  /// Norm of b without the contribution of a uniform pressure, the mean of those `given` at boundary faces [Pa], so that a
  /// tolerance relative to it does not depend on the level of the pressure; at least what rounding allows. Collective.
  double size_without_level(const Placement<D>& at, std::span<const double> b, std::span<const double> given,
                            double tolerance) const;

 private:
  void make_solver();
  std::vector<double> diagonal(const Placement<D>& at, const Diagonal& added) const;
  void remove_mean(std::vector<double>& b) const;
  linalg::SolveStatistics solve_or_report(const Placement<D>& at, std::span<const double> b,
                                          std::span<double> p, double relative, double absolute);
  const mesh::Mesh& mesh_;
  const Boundary<D>& boundary_;
  bool fixed_, regular_ = false;
  bool pinned_ = true;  // one cell's pressure is zero if it is determined up to a constant
  bool direct_;         // small 2-D meshes: Cholesky factors are kept
  std::unique_ptr<linalg::CellSolver> solver_;
  void fill(std::span<const double> coefficients);
  // Moving mesh only. Matrix entries: diagonal per owned cell, then one entry per face. The
  // preconditioner is stored with the entries it was made from, now and at the accepted level.
  std::vector<double> values_;
  struct Lagging {
    linalg::PreconditionerMemory memory;
    std::shared_ptr<const std::vector<double>> made_from;
  };
  Lagging now_, accepted_;
};

/// dp/dt at the end of a step from pressures at mid-steps: rate p + sum past_k p_k, with p of this step and
/// p_k of earlier ones. It is the derivative of the parabola through three levels, (2 p - 3 p_1 + p_2)/dt for
/// equal steps, of a line through two, and 0 with one. L-stable for waves: with W = c k dt, (2 z - 1)(z -
/// 1)^2 + W^2 z^3 = 0 has |z| < 1.
struct WaveRule {
  double rate = 0;  ///< [1/s]; 0 if there is no earlier level, and the step is incompressible
  std::array<double, 2> past{};
};

/// `times`: times of earlier levels, latest first; only two are used.
inline WaveRule three_level_rule(double middle, double end, std::span<const double> times) {
  WaveRule rule;
  const double h = end - middle;
  if (times.empty()) return rule;
  const double h1 = end - times[0];
  if (times.size() == 1) {
    rule.rate = 1 / (h1 - h);
    rule.past[0] = -rule.rate;
    return rule;
  }
  const double h2 = end - times[1];
  rule.rate = (h1 + h2) / ((h1 - h) * (h2 - h));
  rule.past[0] = (h + h2) / ((h - h1) * (h2 - h1));
  rule.past[1] = (h + h1) / ((h - h2) * (h1 - h2));
  return rule;
}

/// Weights of v at t^{n+1}, t^n and t^{n-1} for a second-order value at t^{n+1/2}. Stiff components decay by
/// -1/3 per step, as in the implicit viscous term. `old`: size of the previous step, or 0.
inline std::array<double, 3> middle_weights(double dt, double old) {
  constexpr double c = 1.0 / 16;
  if (old <= 0) return {1, 0, 0};
  const double a = 0.5 + c * old / dt;
  return {a, 1 - a - c, c};
}

/// Rule of a step, with at most three levels.
template <int D>
WaveRule wave_rule(const FluidStep<D>& step) {
  std::array<double, 2> times{};
  std::size_t levels = 0;
  while (levels < times.size() && step.by.pressure[levels]) {
    times[levels] = step.by.pressure[levels]->time;
    ++levels;
  }
  return three_level_rule(step.middle(), step.end(), std::span(times).first(levels));
}
/// Factor of p in dp/dt at the end of the step [1/s]; 0 in a step that starts a flow without a pressure.
template <int D>
double wave_rate(const FluidStep<D>& step, bool trapezoidal) {
  if (!step.by.pressure[0]) return 0;
  return trapezoidal ? 4 / step.dt : wave_rule(step).rate;
}

/// Right-hand side of the pressure equation.
struct RightSide {
  std::vector<double> b;  ///< per owned cell
  double size = -1;       ///< norm for the tolerance, see PressureEquation::solve(); negative: |b|
  /// Part of p that is known, per local cell [Pa], for which b has no entry: the response to lumped ends. Empty if there is none.
  std::vector<double> known;
  double floor = 0;          ///< absolute tolerance that the rounding of the known part allows
  std::vector<double> ends;  ///< pressures of the lumped ends in the guess of p [Pa]; empty if there are none
};

/// Feature in the pressure equation. Every function is called once per step or solve and itself loops over
/// faces or cells. Scene, step and prediction are those of the current step.
template <int D>
class Term {
 public:
  Term(const Scene<D>& scene, const FluidStep<D>& step, const Prediction<D>& prediction)
      : scene_(scene), mesh_(scene.mesh), step_(step), prediction_(prediction) {}
  virtual ~Term() = default;

  /// Called after the prediction from a level. Collective.
  virtual void prepare(const State<D>&) {}

  /// True if the term may change the matrix.
  virtual bool is_in_matrix() const { return true; }
  /// True if the pressure is part of the state, not only the impulse of a step.
  virtual bool keeps_pressure() const { return false; }
  /// True if the term determines the pressure level of a closed domain in this step.
  virtual bool sets_level() const { return false; }
  /// Changes whenever the matrix entries do, on a mesh at rest. 0 stands for a matrix without terms.
  virtual double version() const { return 0; }
  virtual void add_to_diagonal(Diagonal&) {}
  /// Called with a new matrix. Collective.
  virtual void respond(PressureEquation<D>&) {}

  /// Changes given fluxes of the boundary for which the equation has no solution. Collective.
  virtual void balance(const PressureEquation<D>&, Projected<D>&) {}
  /// Sets pressures, velocities and fluxes of the boundary that are known before p. Collective.
  virtual void foresee(const State<D>&, Projected<D>&) {}
  /// Adds to the right-hand side. Collective.
  virtual void before(Projected<D>&, RightSide&) {}
  /// Sets pressures, velocities and fluxes of the boundary once p is known. Collective.
  virtual void after(Projected<D>&) {}

  /// Adds data to the level that the next step needs and that depend on p.
  virtual void complete(PressureLevel<D>&) const {}
  /// Advances the state of the term from level n to n+1. Collective.
  virtual void commit(const Projected<D>&, State<D>&) const {}
  /// Initializes a pressure and a state that no step computed. Collective.
  virtual void start(const Placement<D>&, PressureLevel<D>&) const {}
  virtual void start(State<D>&) const {}

  /// State of the solvers in addition to the level, as of the last accept(). Collective.
  virtual void accept() {}
  virtual void visit(io::Archive&) {}

 protected:
  const Scene<D>& scene_;
  const mesh::Mesh& mesh_;
  const FluidStep<D>& step_;
  const Prediction<D>& prediction_;
};

template <int D>
using Terms = std::vector<std::unique_ptr<Term<D>>>;
/// Adds the term T if the case has it.
template <class T, int D>
void add_term(bool has, const Scene<D>& scene, const FluidStep<D>& step, const Prediction<D>& prediction,
              Terms<D>& terms) {
  if (has) terms.push_back(std::make_unique<T>(scene, step, prediction));
}
/// Adds those of a fluid without an outlet, and of walls of known mass (Robin condition).
template <int D>
void add_wall_terms(const Scene<D>& scene, const FluidStep<D>& step, const Prediction<D>& prediction,
                    Terms<D>& terms);
/// Adds those of weak compressibility: of openings that let pressure waves out, of the cells.
template <int D>
void add_compressible_terms(const Scene<D>& scene, const FluidStep<D>& step, const Prediction<D>& prediction,
                            Terms<D>& terms);

/// Adds that of lumped ends: a volume behind the inlets, circuits behind outlets.
template <int D>
void add_end_terms(const Scene<D>& scene, const FluidStep<D>& step, const Prediction<D>& prediction,
                   Terms<D>& terms);

/// Second stage of a step: sum g (p_N - p_P) = (rho/dt) sum phi^p, p = p^{n+1/2}, in passes on non-orthogonal
/// meshes. Features extend it by a list of terms, which is empty for an incompressible fluid and given walls.
template <int D>
class PressureProjection {
 public:
  /// `moving`: the mesh will move. `result`: filled by project(). Collective.
  PressureProjection(const Scene<D>& scene, const FluidStep<D>& step, const Prediction<D>& prediction,
                     Projected<D>& result, bool moving);

  /// Prepares the guess p~, the initial non-orthogonal gradient, the terms and the matrix. Collective.
  void prepare(const State<D>& from);
  /// Begins the next project() with the pressure of a level, or with the extrapolated one for nullptr.
  void start_from(const PressureLevel<D>* level);
  /// Computes p and p_b for given velocities w at t^{n+1} from predicted fluxes, without and then with
  /// -(dt/rho) grad p~ . k. `answer`: see PressureEquation::solve(). Collective.
  void project(const State<D>& from, const Vectors<D>& w, const std::vector<double>& phi, double answer);
  /// Adds Projected::rotational to a level, for the next predictor. Collective.
  void add_rotational(PressureLevel<D>& level) const;

  /// Sets up the matrix for a state that no step computed. Collective.
  void start(const Placement<D>& at);
  /// Sets p to the potential psi that makes phi^p divergence-free for the boundary fluxes of w. Collective.
  void solve_initial(const Placement<D>& at);
  /// Sets phi^p at the boundary from w. Collective.
  void set_boundary_flux(const Vectors<D>& w);
  /// Returns the last project() as a level of history; `correction`: fluxes computed alongside. Collective.
  std::shared_ptr<PressureLevel<D>> pressure_level(const FluxCorrection* correction = nullptr) const;
  /// Fills the data that follow from p and boundary in a level that no step computed. Collective.
  void start(const Placement<D>& at, PressureLevel<D>& level) const;

  /// Discards the matrix after a change of its entries; it is rebuilt when next needed.
  void forget_matrix() { assembled_ = nullptr; }
  PressureEquation<D>& equation() { return equation_; }
  const Terms<D>& terms() const { return terms_; }
  int iterations() const { return iterations_; }
  /// Projects a velocity by the adjoint of a step on a mesh at rest, in the inner product of the kinetic energy. If a skew force acts on
  /// the result, the step lets it do no work. `u_boundary`: at the boundary faces. Collective.
  Vectors<D> adjoint(const Placement<D>& at, const Vectors<D>& u, const Vectors<D>& u_boundary);
  /// State of the solvers in addition to the level, as of the last accept(). load() is collective.
  void accept();
  void save(io::CheckpointWriter& file) const;
  void load(io::CheckpointReader& file);

 private:
  void extrapolate_pressure();
  void assemble();
  void set_obliqueness(const Placement<D>& at);
  void add_oblique_pressure(const std::vector<double>& phi);
  bool mix_gradients(int pass);
  double rounding() const;
  void transposed_flux(const Placement<D>& at, const Vectors<D>& u, const Vectors<D>& u_boundary,
                       std::vector<double>& flux) const;
  Vectors<D> transposed_mean(const Placement<D>& at, const std::vector<double>& value) const;
  void solve_pressure(const State<D>& from, const Vectors<D>& w, double tolerance, double answer);
  void set_rotational();
  void set_distances();
  void set_boundary_pressure(const State<D>& from);
  void set_gradient(const Placement<D>& at, PressureLevel<D>& level, const FluxCorrection* correction) const;
  void pressure_gradient(const Placement<D>& at, const std::vector<double>& p,
                         const std::vector<double>& boundary, const FluxCorrection* correction,
                         Vectors<D>& sum) const;

  const Scene<D>& scene_;
  const mesh::Mesh& mesh_;
  const FluidStep<D>& step_;
  const Prediction<D>& prediction_;
  Projected<D>& out_;
  Terms<D> terms_;
  PressureEquation<D> equation_;
  bool has_level_ = std::ranges::any_of(scene_.parameters.boundaries, [](const auto& b) {
    return b.second.pressure.text != "0";
  });  // an outlet may have a pressure other than 0
  RightSide side_;
  std::shared_ptr<const Placement<D>> assembled_;  // placement of the matrix
  std::vector<double> versions_;                   // versions of the terms in the matrix
  int iterations_ = 0;                             // total so far
  // Non-orthogonal meshes only.
  double degrees_ = 0;         // largest angle between a face normal and the line of its cells
  Vectors<D> gradient_start_;  // of p, for the first pass
  Vectors<D> gradient_before_;
  bool knows_distances_ = false;
  std::vector<double> to_opening_;  // squared distance to the nearest opening, per local cell [m^2]
  std::unique_ptr<linalg::VectorAccelerator> accelerator_;
};

}  // namespace couplet::fluid
