// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "solid_solver/body/solid_body.hpp"
#include "solid_solver/method/solution_method.hpp"

namespace couplet::solid {

/// Sensitivity of a functional J(u) = j . u of a linear static body to its mesh error. A symmetric operator
/// lets K z = j use the matrix, preconditioner and factors of K u = b:
///   J(u_exact) - J(u) ~ sum_f V_f dE_f(u) : C : dE_f(z)
/// The strain difference dE of two face gradients replaces the errors of u and z ([becker2001]; with
/// recovered strains: Zienkiewicz and Zhu, IJNME 24 (1987) 337). Terms keep their sign, so they cancel as in
/// J. Requires a symmetric kernel.
class DualProblem {
 public:
  /// Keeps references. Compares the gradients of u. Collective.
  DualProblem(const SolidBody& body, std::span<const double> unknowns, std::span<const double> known);

  /// j of a weighted sum of point displacements. `weights`: `dim` values per local point. Collective.
  std::vector<double> of_points(std::span<const double> weights) const;
  /// j of the mean of weights : stress over the owned `cells` of all ranks. Collective.
  std::vector<double> of_stress(std::span<const Index> cells, const Tensor3& weights) const;
  /// Evaluates the sum above. Throws SolveFailure. Collective.
  double missed(std::span<const double> j, SolutionMethod& method) const;

 private:
  std::vector<Tensor3> gap(std::span<const double> unknowns, std::span<const double> known) const;

  const SolidBody& body_;
  const elastic::ElasticKernel other_;
  std::vector<Tensor3> gap_;  // of u, one per flux face
};

}  // namespace couplet::solid
