// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <span>
#include <vector>

#include "common/elasticity/elasticity.hpp"
#include "common/mesh/mesh.hpp"
#include "solid_solver/body/quadratic_fit.hpp"

namespace couplet::solid {

/// Compares face strains with recovered ones: a linear strain per cell, fitted to the means of cells that
/// share a vertex. The energy of the difference, over the faces' pyramids, estimates the mesh error
/// (Zienkiewicz and Zhu, IJNME 33 (1992) 1331):
///   sum_f V_f (e_f - e*(x_f)) : C : (e_f - e*(x_f)) / sum_f V_f e_f : C : e_f
/// Ratio to the true displacement error (scripts/validate solid-accuracy): 0.8-2 on plates, 0.6-4 on
/// hexahedral beams, 0.3-3 on bent tetrahedra; the difference of two gradients gives 3-30 on hexahedra and
/// 7-170 on tetrahedra. The ratio is smallest if long cells make the body too stiff, and about ten for a
/// single layer of hexahedra, see StrainAudit::missed_by_mesh(). Needs two passes over faces.
class RecoveredStrain {
 public:
  /// Keeps references.
  RecoveredStrain(const mesh::Mesh& mesh, const elastic::ElasticOperator& rows);
  Index n_faces() const { return mesh_.n_flux_faces(); }
  /// Adds a strain in the first pass; strains of partition faces on both ranks.
  void add(Index face, const Tensor3& strain);
  /// Call between the passes. Collective.
  void recover();
  /// Compares a strain in the second pass.
  void compare(Index face, const Tensor3& strain);
  /// Relative energy of the difference; 0 if there is no energy. Collective.
  double missed() const;

 private:
  /// At the cell center and per meter along the axes; packed as the six components of the symmetric tensor.
  using Linear = std::array<std::array<float, 6>, 4>;
  template <class Visit>
  void visit_pyramids(Index face, const Visit& visit) const;
  Linear fit(Index cell, const std::vector<Index>& patch) const;

  const mesh::Mesh& mesh_;
  const mesh::Geometry& geometry_;
  const elastic::ElasticOperator& rows_;
  std::vector<double> mean_;    // per local cell, six each
  std::vector<double> volume_;  // pyramid volume per local cell [m^3]
  std::vector<Index> slot_;     // per owned cell its index in linear_; -1 if not used
  std::vector<Linear> linear_;
  double difference_ = 0, whole_ = 0;
};

/// Compares two strain energies of a displacement. One is that of the operator, by face strains over their
/// pyramids. The other is smooth: it integrates a quadratic per cell, fitted to the vertices of cells that
/// share a vertex. The difference measures the error of the operator's stiffness for this displacement
/// (recovered displacements: Naga and Zhang, SIAM J. Numer. Anal. 42 (2004) 1780).
///
/// Ratio to the true displacement error (scripts/validate solid-accuracy): 0.3-1.2 on triangles (Cook's
/// panel, a ring, an orthotropic bar; recovered strains: 0.02-1.1). It is far too large on sheared structured
/// triangles, whose errors cancel. On other cells it is less reliable: 0.3-40 on bent tetrahedra.
class SmoothEnergy {
 public:
  /// Keeps references.
  SmoothEnergy(const mesh::Mesh& mesh, const elastic::ElasticOperator& rows);
  /// True for meshes of triangles. Collective.
  static bool is_of_use(const mesh::Mesh& mesh);

  /// Adds the displacement gradient of a flux face; add those of partition faces on both ranks.
  void add(Index face, const Tensor3& gradient);
  /// Relative difference of the operator's energy from the smooth one; 0 if there is none. `point_u`:
  /// displacement of all local points, `dim` values each [m]. Samples at most about 20 000 cells, evenly.
  /// Collective.
  double missed(std::span<const double> point_u) const;

 private:
  struct Patch;
  void gather(Index cell, Patch& patch) const;
  double smooth_energy(Index cell, const Patch& patch, std::span<const double> point_u) const;

  const mesh::Mesh& mesh_;
  const mesh::Geometry& geometry_;
  const elastic::ElasticOperator& rows_;
  std::vector<double> counted_;  // per owned cell: sum V_fP G : C : G
};

}  // namespace couplet::solid
