// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <span>
#include <string>
#include <vector>

#include "common/elasticity/elasticity.hpp"
#include "common/io/probes/probe.hpp"
#include "common/mesh/mesh.hpp"
#include "solid_solver/body/solid_body.hpp"
#include "solid_solver/body/solid_fields.hpp"
#include "solid_solver/method/solution_method.hpp"
#include "solid_solver/output/files.hpp"
#include "solid_solver/thermal/heat.hpp"

namespace couplet::solid {

/// Displacement at a place in or near an owned cell, by a quadratic fit to cells of its material that share a
/// vertex and to their boundary faces. At symmetry planes the patch is continued by its mirror image. Surface
/// vertices use weights that are exact only for linear fields; the fit adds the curvature. `cell_u`,
/// `face_u`: all local cells and boundary faces, `dim` values each.
Vec3 quadratic_displacement(const mesh::Mesh& mesh, const elastic::ElasticOperator& rows, Index cell,
                            const Vec3& place, std::span<const double> cell_u,
                            std::span<const double> face_u);

/// Quantity of interest of a linear static run with its mesh error from the dual problem.
struct QuantityEstimate {
  std::string name, what;  ///< for example "displacement y"
  std::string unit;
  Vec3 place = Vec3::Zero();  ///< undeformed [m]
  double value = 0;           ///< as the probes have it
  /// Error at the place itself: of a displacement by the curvature that vertex weights miss
  /// (quadratic_displacement()), of a stress by the residual of its recovery. Of a heat flow, what the chords of curved
  /// boundaries leave out.
  double local = 0;
  double dual = 0;  ///< DualProblem::missed()
  /// Variation within the quadrilaterals of the whole body times the value. Covers cases where the other parts miss
  /// the error, such as regular cells in bending, whose residuals cancel.
  double body = 0;
  std::string patch{};     ///< of a heat flow, instead of `place`
  bool is_signed = false;  ///< both parts have the sign of the error
  /// Error in the unit: the larger part, or with signs the sum, but at least half the larger part, because
  /// cancellation is only first order. Never less than `body`. Displacement errors are within a factor of 3,
  /// except for 3-D bending, where they are 4 to 50 times too large (scripts/validate error-estimates).
  double error() const;
};

/// Position of a quantity in the case [m]; 0 without a point.
Vec3 place_of(const SolidQuantity& quantity);

/// Estimates `quantities`, one solve with `method` each. `unknowns` and `state`: accepted. Equal on all
/// ranks. Throws SolveFailure, and Error if the operator has no energy. Collective.
std::vector<QuantityEstimate> estimate_quantities(const SolidBody& body, const SolidFields& fields,
                                                  const SolidState& state, SolutionMethod& method);

/// Reports findings and writes quantities.csv.
void tell_quantities(MPI_Comm comm, const SolidContext& context, const std::vector<QuantityEstimate>& found);

/// Sensitivity of a functional J(u) = j . u of a linear static body to its mesh error. A symmetric operator
/// lets K z = j use the matrix, preconditioner and factors of K u = b:
///   J(u_exact) - J(u) ~ sum_f V_f dE_f(u) : C : dE_f(z)
/// The difference dE of face strains and recovered ones replaces the errors of u and z ([becker2001]; Zienkiewicz
/// and Zhu, IJNME 24 (1987) 337). Terms keep their sign, so they cancel as in J. Requires a symmetric kernel.
class DualProblem {
 public:
  /// Keeps a reference. Collective.
  DualProblem(const SolidBody& body, std::span<const double> unknowns, std::span<const double> known);

  /// j of a weighted sum of point displacements. `weights`: `dim` values per local point. Collective.
  std::vector<double> of_points(std::span<const double> weights) const;
  /// j of the mean of weights : stress over the owned `cells` of all ranks. Collective.
  std::vector<double> of_stress(std::span<const Index> cells, const Tensor3& weights) const;
  /// Evaluates the sum above. Throws SolveFailure. Collective.
  double missed(std::span<const double> j, SolutionMethod& method) const;

 private:
  std::vector<Tensor3> strains_of(std::span<const double> unknowns, std::span<const double> known) const;

  const SolidBody& body_;
  const std::vector<Tensor3> strain_;  // of u, one per flux face
};

/// Throws Error for a missing place or patch and for varying conductivities. Collective.
void check_heat_quantities(const Heat& heat, const std::map<std::string, SolidQuantity>& quantities);

/// Temperatures at places and heat flows through patches of a steady field, with their mesh errors
/// (weighted_defect() in the source). Each needs one solve with the same matrix. A temperature adds the
/// signed interpolation error at its place. Equal on all ranks. Throws SolveFailure. Collective.
std::vector<QuantityEstimate> estimate_heat_quantities(
    const Heat& heat, const std::map<std::string, SolidQuantity>& quantities);

}  // namespace couplet::solid
