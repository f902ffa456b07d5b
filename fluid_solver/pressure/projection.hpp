// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <vector>

#include "common/linalg/acceleration.hpp"
#include "fluid_solver/pressure/pressure.hpp"
#include "fluid_solver/state/state.hpp"

namespace couplet::fluid {

/// Second stage of a step: sum g (p_N - p_P) = (rho/dt) sum phi^p, p = p^{n+1/2}, in passes on non-orthogonal
/// meshes. Features extend it by a list of terms, which is empty for an incompressible fluid and given walls.
template <int D>
class PressureProjection {
 public:
  /// `moving`: the mesh will move. `result`: filled by project(). Collective.
  PressureProjection(const Scene<D>& scene, const Step<D>& step, const Prediction<D>& prediction,
                     Projected<D>& result, bool moving);

  /// Prepares the guess p~, the initial non-orthogonal gradient, the terms and the matrix. Collective.
  void prepare(const State<D>& from);
  /// Begins the next project() with the pressure of a level, or with the extrapolated one for nullptr.
  void start_from(const PressureLevel<D>* level);
  /// Computes p and p_b for given velocities w at t^{n+1} from predicted fluxes, without and then with
  /// -(dt/rho) grad p~ . k. `answer`: see PressureEquation::solve(). Collective.
  void project(const State<D>& from, const Vectors<D>& w, const std::vector<double>& phi, double answer);

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
  const std::vector<std::unique_ptr<Term<D>>>& terms() const { return terms_; }
  int iterations() const { return iterations_; }
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
  void solve_pressure(const State<D>& from, const Vectors<D>& w, double tolerance, double answer);
  void set_boundary_pressure(const State<D>& from);
  void set_gradient(const Placement<D>& at, PressureLevel<D>& level, const FluxCorrection* correction) const;
  void pressure_gradient(const Placement<D>& at, const std::vector<double>& p,
                         const std::vector<double>& boundary, const FluxCorrection* correction,
                         Vectors<D>& sum) const;

  const Scene<D>& scene_;
  const mesh::Mesh& mesh_;
  const Step<D>& step_;
  const Prediction<D>& prediction_;
  Projected<D>& out_;
  std::vector<std::unique_ptr<Term<D>>> terms_;
  PressureEquation<D> equation_;
  RightSide side_;
  std::shared_ptr<const Placement<D>> assembled_;  // placement of the matrix
  std::vector<double> versions_;                   // versions of the terms in the matrix
  int iterations_ = 0;                             // total so far
  // Non-orthogonal meshes only.
  double degrees_ = 0;         // largest angle between a face normal and the line of its cells
  Vectors<D> gradient_start_;  // of p, for the first pass
  Vectors<D> gradient_before_;
  std::unique_ptr<linalg::Accelerator> accelerator_;
};

}  // namespace couplet::fluid
