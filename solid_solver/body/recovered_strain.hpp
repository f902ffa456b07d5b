// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <span>
#include <vector>

#include "common/elasticity/elasticity.hpp"
#include "common/mesh/mesh.hpp"
#include "solid_solver/body/quadratic_fit.hpp"
#include "solid_solver/body/solid_body.hpp"

namespace couplet::solid {

/// Stiffness that the strains of a quadrilateral's four faces add to that of their mean. Over n cells across
/// a bent bar, face strains give a second moment of area of 1 + 1/(2 n^2) times the exact one, and cell means
/// 1 - 1/n^2. A third of the difference is the relative error of the symmetric gradient with face volume
/// strains, in energy and so in displacement. Two face gradients do not detect it. It cancels in 3-D.
class InnerVariation {
 public:
  /// Keeps references to both.
  InnerVariation(const mesh::Mesh& mesh, const elastic::ElasticOperator& rows);
  /// True in 2-D, isotropic or not, if the operator uses the volume strain of faces.
  static bool is_needed(const mesh::Mesh& mesh, const elastic::ElasticOperator& rows);
  /// Adds the strain of a flux face; add those of partition faces on both ranks.
  void add(Index face, const Tensor3& strain);
  /// Missed part relative to the strain energy of all cells; 0 if there is none. Collective.
  double missed() const;

 private:
  const mesh::Mesh& mesh_;
  const mesh::Geometry& geometry_;
  const elastic::ElasticOperator& rows_;
  std::vector<double> energy_;   // per owned cell: sum V_fP e : C : e
  std::vector<Tensor3> strain_;  // sum V_fP e
  std::vector<double> volume_;   // sum V_fP
};

/// Compares face strains with recovered ones: a linear strain per cell, fitted to the means of cells that share a vertex. The energy of the
/// difference, over the faces' pyramids, estimates the mesh error (Zienkiewicz and Zhu, IJNME 33 (1992) 1331):
///   sum_f V_f (e_f - e*(x_f)) : C : (e_f - e*(x_f)) / sum_f V_f e_f : C : e_f
/// The volume strain of faces does not count where that of cells has the energy. Ratio to the true displacement error (scripts/validate
/// solid-accuracy): 0.8-2 on plates, 0.6-4 on hexahedral beams, 0.3-3 on bent tetrahedra. It is smallest if long cells make the body too
/// stiff, and about ten for a single layer of hexahedra, see is_one_row(). Needs two passes over faces.
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
  /// True if most cells have no neighbors along some axis. A slope is not recovered there, and all bending would be missed. Collective.
  bool is_one_row() const;
  /// Part of a strain at a face that the recovered one of the cell has not; zero for a cell that was not recovered.
  Tensor3 gap(Index face, Index cell, const Tensor3& strain) const;
  /// a : C : b of a cell [Pa], without the volume strain where cells have their own.
  double product(Index cell, const Tensor3& a, const Tensor3& b) const;
  /// Number of cells for each one recovered.
  double cells_per_patch() const { return double(stride_); }

 private:
  /// At the cell center and per meter along the axes; packed as the six components of the symmetric tensor.
  using Linear = std::array<std::array<float, 6>, 4>;
  template <class Visit>
  void visit_pyramids(Index face, const Visit& visit) const;
  Linear fit(Index cell, const std::vector<Index>& patch);

  const mesh::Mesh& mesh_;
  const mesh::Geometry& geometry_;
  const elastic::ElasticOperator& rows_;
  std::vector<double> mean_;    // per local cell, six each
  std::vector<double> volume_;  // pyramid volume per local cell [m^3]
  std::vector<Index> slot_;     // per owned cell its index in linear_; -1 if not used
  std::vector<Linear> linear_;
  GlobalIndex stride_ = 1;
  double difference_ = 0, whole_ = 0;
  double single_ = 0;  // cells without neighbors along some axis
};

/// Parts of the stiffness that the mesh adds, relative to the strain energy of a displacement.
struct MissedStrain {
  double recovered = 0;     ///< RecoveredStrain::missed(); 0 unless asked for
  double variation = 0;     ///< InnerVariation::missed() where it is needed
  bool is_one_row = false;  ///< RecoveredStrain::is_one_row()
};
/// `strain`: returns the strain of a displacement gradient. Collective.
MissedStrain missed_strain(const SolidBody& body, std::span<const double> unknowns,
                           std::span<const double> known, Tensor3 (*strain)(const Tensor3&),
                           bool recovers = true);

/// sum_f V_f (a_f - a*) : C : (b_f - b*) of two strains of the flux faces and their recovered ones [J]. Signed;
/// strains of partition faces on both ranks. Collective.
double missed_product(const mesh::Mesh& mesh, const elastic::ElasticOperator& rows,
                      std::span<const Tensor3> a, std::span<const Tensor3> b);

}  // namespace couplet::solid
