// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <vector>

#include "common/elasticity/solve/elastic_preconditioner.hpp"
#include "common/linalg/krylov.hpp"
#include "solid_solver/method/pressure_schur.hpp"
#include "solid_solver/method/solution_method.hpp"

namespace couplet::solid {

/// The symmetric operator with the mean stresses p of its cells as unknowns beside the displacements [boffi2013],
///   [ K' + mM    B^T   ] [u]   [b]
///   [    B     -V / K_P] [p] = [0],
/// whose iterations hardly grow as nu goes to 1/2, where those of conjugate gradients on K = K' + B^T (K_P / V) B have no
/// end. Preconditioner: block triangular, for p the Schur complement (PressureSchur), for u the compact
/// component-wise operator of K' + mM (ElasticPreconditioner). p is no state of its own: the stress of u is K_P theta, so
/// that rows of volumes are weighed by what is left of them there.
class MixedForm final : public SolutionMethod {
 public:
  MixedForm(const SolidProblem& problem, const MethodParameters& parameters);
  linalg::SolveStatistics solve(std::span<const double> b, std::span<double> u) override;
  /// The rows of the mixed form and their preconditioner: displacements, then mean stresses over their scale. Collective.
  void apply(std::span<const double> x, std::span<double> y);
  void precondition(std::span<const double> r, std::span<double> z);
  std::size_t n_unknowns() const { return n_u_ + n_p_; }

 private:
  void find_scales();
  void add_pressures(std::span<const double> b, std::span<double> x);

  SolidProblem problem_;
  linalg::KrylovOptions options_;
  double forces_left_;  // by the rows of volumes, over the right-hand side
  std::size_t n_u_, n_p_;
  std::unique_ptr<elastic::ElasticPreconditioner> multigrid_;
  PressureSchur schur_;
  std::vector<double> scale_;      // p over its unknown, and its row [N] over a volume [Pa/m, N/m^3]
  std::vector<double> stiffness_;  // K_P / V [Pa/m^3]
  std::vector<double> with_pressures_, forces_;
  std::unique_ptr<linalg::KrylovSolver> krylov_;
};

}  // namespace couplet::solid
