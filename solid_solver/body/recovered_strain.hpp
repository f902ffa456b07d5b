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

}  // namespace couplet::solid
