// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <vector>

#include "common/elasticity/elasticity.hpp"
#include "common/mesh/mesh.hpp"

namespace couplet::solid {

/// The strains of faces against recovered ones: in each cell a linear strain, fitted to the means of the cells that share a vertex
/// with it. The energy of their difference is what the mesh misses (Zienkiewicz and Zhu, Int. J. Numer. Meth. Eng. 33 (1992) 1331), over
/// the faces' pyramids:
///   sum_f V_f (e_f - e*(x_f)) : C : (e_f - e*(x_f)) / sum_f V_f e_f : C : e_f
///
/// Beside the true error of the displacement (scripts/validate solid-accuracy): 0.8 to 2 times on plates, 0.6 to 4 on beams of hexahedra, for which the
/// difference of two face gradients is 3 to 30 times it; 0.3 to 3 on tetrahedra that bend (that difference: 7 to 170), least where long cells
/// make the whole body too stiff. One hexahedron across shows no slope: ten times, see StrainAudit::missed_by_mesh(). Added in two passes over the flux faces, see strain_audit.cpp.
class RecoveredStrain {
 public:
  /// By reference.
  RecoveredStrain(const mesh::Mesh& mesh, const elastic::ElasticOperator& rows);
  Index n_faces() const { return mesh_.n_flux_faces(); }
  /// First pass; strains of partition faces on both ranks.
  void add(Index face, const Tensor3& strain);
  /// Between the passes. Collective.
  void recover();
  /// Second pass.
  void compare(Index face, const Tensor3& strain);
  /// Share of the energy; 0 where there is none. Collective.
  double missed() const;

 private:
  /// At the cell's centre and per metre along the axes; packed as the symmetric tensor's six components.
  using Linear = std::array<std::array<float, 6>, 4>;
  template <class Visit>
  void visit_pyramids(Index face, const Visit& visit) const;
  Linear fit(Index cell, const std::vector<Index>& patch) const;

  const mesh::Mesh& mesh_;
  const mesh::Geometry& geometry_;
  const elastic::ElasticOperator& rows_;
  std::vector<double> mean_;    // of local cells, six each
  std::vector<double> volume_;  // of their pyramids [m^3]
  std::vector<Index> slot_;     // per owned cell its place in linear_; -1: not looked at
  std::vector<Linear> linear_;
  double difference_ = 0, whole_ = 0;
};

}  // namespace couplet::solid
