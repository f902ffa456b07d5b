// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "common/linalg/matrix.hpp"
#include "solid_solver/boundary/seat.hpp"
#include "solid_solver/equilibrium/equilibrium.hpp"
#include "solid_solver/method/solution_method.hpp"
#include "solid_solver/parameters/parameters.hpp"
#include "solid_solver/thermal/thermal_load.hpp"

namespace couplet::solid {

/// System K u = b + C^T f(C u) with the forces f of the seat.
struct ContactProblem {
  MPI_Comm comm;
  const linalg::LinearMap& stiffness;  ///< K, including inertia
  SolutionMethod& method;              ///< for K alone
  Pressing& pressing;
  std::span<const double> known;  ///< known columns of C; their part of K is in b
  double tolerance;               ///< of the residual relative to the rows
  int most_iterations;            ///< of the linear solver
};

/// Semi-smooth Newton method [hueber2005]. The forces derive from a convex energy, so with exact line search it converges at any stiffness.
/// The tangent K + C^T k C is solved by CG with the preconditioner of K. A body clear of the seat is solved by the method of K and checked
/// once. `u`: first guess on entry. Throws SolveFailure. Collective.
linalg::SolveStatistics solve_with_contact(const ContactProblem& problem, std::span<const double> b,
                                           std::span<double> u);

/// Clears the component out of the plane in plane stress; in plane strain it is lambda tr(epsilon).
void clear_stress_across(const SolidParameters& parameters, std::span<Tensor3> stress);

/// A(u) = K u in the reference configuration, with the face gradient that was chosen.
class SmallStrain final : public Equilibrium {
 public:
  /// Keeps references.
  SmallStrain(const mesh::Mesh& mesh, const elastic::ElasticKernel& kernel,
              const elastic::ElasticOperator& rows, const std::unique_ptr<ThermalLoad>& thermal,
              const SolidParameters& parameters)
      : mesh_(mesh), kernel_(kernel), rows_(rows), thermal_(thermal), parameters_(parameters) {}

  linalg::SolveStatistics find(const EquilibriumLoad& load, SolidSystem& system,
                               std::span<double> u) override;
  std::vector<double> forces(std::span<const double> unknowns, std::span<const double> known) override;
  double energy(std::span<const double> unknowns, std::span<const double> known) override;
  std::vector<elastic::Wrench> holding_forces(std::span<const double> unknowns, std::span<const double> known,
                                              const elastic::ElasticLoads& loads) override;
  std::vector<Tensor3> face_stress(const Displaced& state, Index first, Index count) override;
  std::vector<Tensor3> cell_stress(const Displaced& state) override;

 private:
  const mesh::Mesh& mesh_;
  const elastic::ElasticKernel& kernel_;
  const elastic::ElasticOperator& rows_;
  const std::unique_ptr<ThermalLoad>& thermal_;  // created after it; nullptr without temperature
  const SolidParameters& parameters_;
};

}  // namespace couplet::solid
