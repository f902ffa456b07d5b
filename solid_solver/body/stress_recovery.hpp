// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "common/elasticity/elasticity.hpp"
#include "common/mesh/mesh.hpp"
#include "solid_solver/body/quadratic_fit.hpp"
#include "solid_solver/body/stress.hpp"

namespace couplet::solid {

/// Known traction on a boundary face: projector (stress . n) = traction [Pa], n out of the body.
struct SurfaceTraction {
  Tensor3 projector = Tensor3::Zero();  ///< zero if nothing is known
  Vec3 traction = Vec3::Zero();
  bool symmetry = false;  ///< the body is continued by its mirror image
};

/// Discrete solution at small strain.
struct DiscreteStress {
  std::vector<Tensor3> cells, faces;  ///< stress of owned cells, of boundary faces of owned cells [Pa]
  /// Part of the stress that does not depend on the displacement (thermal stress); empty if there is none.
  std::vector<Tensor3> other_in_cells, other_on_faces;
  std::span<const double> cell_u, face_u;  ///< all local cells, boundary faces, `dim` values each [m]
  std::vector<SurfaceTraction> surface;    ///< per boundary face of owned cells
};

/// Stress recovered from patches of cells: each cell gets a quadratic fitted to the cells that share a vertex with it,
/// of its material, to their boundary faces, and to the tractions known there; a point takes the mean of its cells of each
/// material. At planes of symmetry the patch goes on as its mirror image.
///
/// The fit uses the stress, whose cell means are more accurate than derived values (Zienkiewicz and Zhu, IJNME 33 (1992) 1331; with
/// tractions, Blacker and Belytschko, ibid. 37 (1994) 517). For triangles and tetrahedra at a surface it uses the displacement, whose
/// gradient keeps peaks at curved surfaces that face strains smooth (Naga and Zhang, SIAM J. Numer. Anal. 42 (2004) 1780). It uses stress
/// there too if mean stresses are per cell (ElasticOperator::volume_by_cells).
class StressRecovery {
 public:
  /// Keeps references to both. `plane_stress`: true if there is no stress across the plane.
  StressRecovery(const mesh::Mesh& mesh, const elastic::ElasticOperator& rows, bool plane_stress);

  /// Stress [Pa], the mean of the cells around on each side of a joint. `wanted`: flags of local points, empty means all;
  /// others may hold anything. Collective.
  SidedTensors at_points(const DiscreteStress& found, std::span<const std::uint8_t> wanted = {}) const;
  /// Returns the relative error of the stress at each side of the `wanted` points [1], and NaN where it is unknown. The error
  /// is a median over the cells one ring further out, whose quadratics are continued to the point and compared with the
  /// stress there. It is divided by that stress or, if larger, by least_scale(). An error of the displacement as a whole is
  /// not included. `sides`: result of at_points() for the same points. Collective.
  std::vector<std::vector<double>> left_at_points(const DiscreteStress& found,
                                                  std::span<const std::uint8_t> wanted,
                                                  const SidedTensors& sides) const;

 private:
  struct Local;  // fields including ghosts
  struct Patch;
  template <class Wants, class Take>
  void visit(const DiscreteStress& found, const Wants& wants, const Take& take) const;
  Local localise(const DiscreteStress& found) const;
  void gather(Index cell, const Local& local, Patch& patch) const;
  void fit_tensors(Index cell, const std::vector<Tensor3>& cells, const std::vector<Tensor3>& faces,
                   const std::vector<SurfaceTraction>* surface, Patch& patch, QuadraticFit& fit) const;
  void fit_displacement(Index cell, const Local& local, Patch& patch, QuadraticFit& fit) const;
  /// Smallest scale of errors [Pa]: a part of the largest stress, but no less than the round-off of the stress
  /// that loads and displacements could give. Collective.
  double least_scale(const DiscreteStress& found) const;

  const mesh::Mesh& mesh_;
  const mesh::Geometry& geometry_;
  const elastic::ElasticOperator& rows_;
  bool plane_stress_;
  mesh::Csr cells_of_point_, faces_of_cell_;  // boundary faces
  std::vector<Tensor3> moment_;               // per local cell: mean of (x - x_c)(x - x_c)^T [m^2]
};

}  // namespace couplet::solid
