// SPDX-License-Identifier: Apache-2.0
#pragma once

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

namespace couplet::solid {

/// The displacement at a place in or beside an owned cell by a quadratic fitted to the cells that share a vertex with it, of its material,
/// and to their boundary faces; at planes of symmetry the patch continues as its mirror image. A vertex at a surface gets its displacement
/// by weights that are exact for linear fields alone: this is what curvature adds. `cell_u`, `face_u`: of all local cells and boundary
/// faces, `dim` values each.
Vec3 quadratic_displacement(const mesh::Mesh& mesh, const elastic::ElasticOperator& rows, Index cell,
                            const Vec3& place, std::span<const double> cell_u,
                            std::span<const double> face_u);

/// A quantity of interest of a linear static run, and what the mesh leaves in it, by the dual problem.
struct QuantityEstimate {
  std::string name, what;  ///< "displacement y"
  std::string unit;
  Vec3 place = Vec3::Zero();  ///< undeformed [m]
  double value = 0;           ///< as the probes have it
  /// What the place itself adds: a displacement by the curvature that the weights of a vertex miss (quadratic_displacement()), a stress by
  /// what its recovery leaves.
  double local = 0;
  double dual = 0;  ///< DualProblem::missed()
  /// The mesh's share of the displacement of the whole body, times the value: where the parts above miss everything, as on regular cells in
  /// bending, whose residuals cancel.
  double body = 0;
  std::string patch{};     ///< of a heat flow, in place of `place`
  bool is_signed = false;  ///< both parts have the sign of what is missed
  /// In the unit: the larger part; with signs their sum, but at least half the larger, since what cancels does so to first order only; never less than `body`.
  /// Displacements within a factor of 3 of the truth, but for
  /// three-dimensional bodies in bending, where it is 4 to 50 times too large (scripts/validate error-estimates).
  double error() const;
};

/// Where the case puts it [m]; 0 without a point.
Vec3 place_of(const SolidQuantity& quantity);

/// Of `quantities`, one solve with `method` for each; `unknowns` and `state`: accepted. The same on all ranks. Throws SolveFailure, and Error for
/// a body whose operator has no energy. Collective.
std::vector<QuantityEstimate> estimate_quantities(const SolidBody& body, const SolidFields& fields,
                                                  const SolidState& state, SolutionMethod& method);

/// Findings, and quantities.csv with all of it.
void tell_quantities(MPI_Comm comm, const SolidContext& context, const std::vector<QuantityEstimate>& found);

}  // namespace couplet::solid
