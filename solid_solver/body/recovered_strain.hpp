// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <span>
#include <utility>
#include <vector>

#include "common/elasticity/elasticity.hpp"
#include "common/mesh/mesh.hpp"
#include "solid_solver/body/quadratic_fit.hpp"

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

/// The strain energy of a displacement seen twice: as the operator counts it, by the strains of faces over their pyramids, and smooth,
/// by a quadratic a cell, fitted to the vertices of the cells that share one with it, integrated over the cell. How much they
/// differ says how wrong the operator's stiffness is for this displacement (recovered displacements: Naga and Zhang, SIAM J.
/// Numer. Anal. 42 (2004) 1780).
///
/// Beside the true error of the displacement (scripts/validate solid-accuracy): on triangles 0.3 to 1.2 of it on Cook's panel, a ring and
/// an orthotropic bar, where recovered strains see 0.02 to 1.1; far above it where structured triangles are
/// sheared and their errors cancel. On other cells it knows less than those: 0.3 to 40 on tetrahedra that bend.
class SmoothEnergy {
 public:
  /// By reference.
  SmoothEnergy(const mesh::Mesh& mesh, const elastic::ElasticOperator& rows);
  /// Triangles alone. Collective.
  static bool is_of_use(const mesh::Mesh& mesh);

  /// Displacement gradient of a flux face; those of partition faces on both ranks.
  void add(Index face, const Tensor3& gradient);
  /// Share of the smooth energy by which the counted one differs; 0 where there is none. `point_u`: the displacement of
  /// all local points, `dim` values each [m]. Looks at some 20 000 cells at most, evenly
  /// taken. Collective.
  double missed(std::span<const double> point_u) const;

 private:
  struct Patch;
  void gather(Index cell, Patch& patch) const;
  double smooth_energy(Index cell, const Patch& patch, std::span<const double> point_u) const;

  const mesh::Mesh& mesh_;
  const mesh::Geometry& geometry_;
  const elastic::ElasticOperator& rows_;
  std::vector<double> counted_;  // of owned cells: sum V_fP G : C : G
};

}  // namespace couplet::solid
