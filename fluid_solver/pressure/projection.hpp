// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <vector>

#include "fluid_solver/motion/step_work.hpp"
#include "fluid_solver/pressure/pressure.hpp"

namespace couplet::fluid {

/// The second part of a fractional step: sum g (p_N - p_P) = (rho/dt) sum phi^p, p = p^{n+1/2}, in passes on oblique
/// meshes, with what walls and bodies are to it.
template <int D>
class PressureProjection {
 public:
  /// `moving`: the mesh will move.
  PressureProjection(StepWork<D>& work, bool moving);

  /// p~, the guess of the solve, and the gradient that its non-orthogonal part starts with.
  void extrapolate_pressure();
  /// The matrix of the work's step, if that of another placement is there. Collective.
  void assemble();
  /// p and p_b for the given velocities w at t^{n+1}. Collective.
  /// `answer`: PressureEquation::solve().
  void project(const State<D>& from, const Vectors<D>& w, double answer);
  /// psi in p for the boundary fluxes of w: the potential that makes phi^p free of divergence. Collective.
  void solve_initial(const Placement<D>& at);
  /// phi^p at the boundary from w. Collective.
  void set_boundary_flux(const Vectors<D>& w);
  void set_obliqueness(const Placement<D>& at);
  /// The result of the last project() as a level of history. Collective.
  std::shared_ptr<PressureLevel<D>> pressure_level() const;
  /// Fills level.gradient from p and boundary. Collective.
  void set_gradient(const Placement<D>& at, PressureLevel<D>& level) const;
  void mark_bodies(double time);
  /// Of the work's step: which cells of gaps are blocked; the matrix that follows. Collective.
  void mark_gaps();
  void block_gaps(std::vector<double>& phi) const;
  PressureEquation<D>& equation() { return pressure_; }
  const PressureEquation<D>& equation() const { return pressure_; }

 private:
  void balance_closed_domain();
  std::vector<double> admittance() const;
  void foresee_walls(const State<D>& from);
  void let_walls_yield();
  void add_oblique_pressure();
  bool gradient_stands() const;
  void solve_pressure(const State<D>& from, const Vectors<D>& w, double tolerance, double answer);
  void set_boundary_pressure(const State<D>& from, const Vectors<D>& w);
  void pressure_gradient(const Placement<D>& at, const std::vector<double>& p,
                         const std::vector<double>& boundary, Vectors<D>& sum) const;
  void fill_pressure_in_bodies();
  void clear_gaps(std::vector<double>& b) const;
  void part_from_gaps(const Placement<D>& at, const std::vector<double>& p, Vectors<D>& sum) const;
  void clear_bodies(std::vector<double>& values) const;

  StepWork<D>& k_;
  PressureEquation<D> pressure_;
  std::vector<double> b_;
  bool assembled_yielding_ = false;
  Vectors<D> gradient_before_;  // very oblique meshes only
};

}  // namespace couplet::fluid
