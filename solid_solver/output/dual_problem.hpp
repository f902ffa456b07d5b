// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "solid_solver/body/solid_body.hpp"
#include "solid_solver/method/solution_method.hpp"

namespace couplet::solid {

/// How a number J(u) of a linear static body answers to what its mesh leaves in the strains. J(u) = j . u of the unknowns; the operator
/// of an energy is symmetric, so that K z = j has the matrix, preconditioner and factors of K u = b, and
///   J(u_exact) - J(u) near sum_f V_f dE_f(u) : C : dE_f(z)
/// with dE the difference of two face gradients' strains in place of the errors of u and z ([becker2001]; recovered strains in it:
/// Zienkiewicz and Zhu, Int. J. Numer. Meth. Engng 24 (1987) 337). Terms have their sign, so that what cancels in J cancels.
/// Needs a kernel that is symmetric.
class DualProblem {
 public:
  /// All by reference. Compares the gradients of u. Collective.
  DualProblem(const SolidBody& body, std::span<const double> unknowns, std::span<const double> known);

  /// j of the weighted sum of point displacements: `weights`, `dim` values a local point, of this rank alone. Collective.
  std::vector<double> of_points(std::span<const double> weights) const;
  /// j of the mean over the owned `cells` of all ranks of weights : stress. Collective.
  std::vector<double> of_stress(std::span<const Index> cells, const Tensor3& weights) const;
  /// The sum above. Throws SolveFailure. Collective.
  double missed(std::span<const double> j, SolutionMethod& method) const;

 private:
  std::vector<Tensor3> gap(std::span<const double> unknowns, std::span<const double> known) const;

  const SolidBody& body_;
  const elastic::ElasticKernel other_;
  std::vector<Tensor3> gap_;  // of u, one a flux face
};

}  // namespace couplet::solid
