// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <map>
#include <span>
#include <unordered_map>
#include <utility>
#include <vector>

#include "common/elasticity/elasticity.hpp"
#include "common/elasticity/symmetric/face_terms.hpp"
#include "common/elasticity/symmetric/prestress.hpp"
#include "common/linalg/matrix.hpp"

namespace couplet::elastic {

/// The rows of the symmetric operator assembled, without shares of edges: V_f B_f^T C B_f over the faces,
/// springs, the rows of supports, and the kernel's mass of `inertia`, mass factor times density of the owned cells
/// [N/m^4]; empty: none. Where no face shares it is the kernel's K + factor M; else a preconditioner of it. In
/// space some 90 nodes a row on hexahedra and 200 on tetrahedra: for small bodies. Collective.
linalg::SparseMatrix symmetric_matrix(const mesh::Mesh& mesh, const ElasticOperator& rows,
                                      std::span<const double> inertia);

/// dP/dF or C, entry (3 k + a, 3 m + c): what the derivative c of component m does to the stress (k, a) [Pa].
using GradientStiffness = Eigen::Matrix<double, 9, 9>;

/// stiffness K + mass M + stress K_sigma of the symmetric gradient.
struct EnergyParts {
  double stiffness = 1;
  double mass = 0;                       ///< [1/s^2]
  std::span<const double> density{};     ///< of the owned cells [kg/m^3]; for `mass`
  double stress = 0;                     ///< of K_sigma, see StressStiffness
  const Prestress* prestress = nullptr;  ///< for `stress`
};

/// Blocks between unknowns, added up pair by pair and made a matrix. A face of a tetrahedron couples some sixty nodes, and
/// each pair of nodes shares many faces: summed up here there is a fiftieth of the entries for PETSc to sort (a tenth of
/// the time on 1000 tetrahedra).
class Assembly {
 public:
  /// All by reference. Numbers below 2^32.
  Assembly(const mesh::Mesh& mesh, const ElasticOperator& rows, const Numbering& number);

  FaceTerms& terms() { return terms_; }
  void add(GlobalIndex i, GlobalIndex j, const Tensor3& block);
  /// sum_ij T_i^T [b_i . stiffness . b_j] T_j of gradients, `stiffness` times the volume [N m].
  void add(const FaceTermList& terms, const GradientStiffness& stiffness);
  /// Faces of owned cells with what `parts` say of stiffness and stress; of three-cornered ones in space that share with
  /// edges `own` of it.
  void add_faces(const EnergyParts& parts, double own);
  /// The same of the edges. Collective.
  void add_edges(const EnergyParts& parts);
  /// The bulk modulus of cells, on the mean of their faces' volume strains.
  void add_volumes(const EnergyParts& parts);
  /// V_P theta_P of the owned cells beside a face changes by V_fP cofactors b . u.
  void add_volume_terms(Index f, const FaceTermList& terms, const Tensor3& cofactors);
  /// modulus(cell) g g^T of what was added so.
  template <class Modulus>
  void finish_volumes(const Modulus& modulus) {
    for (auto& [cell, terms] : volume_of_) add_squares(terms, modulus(cell));
    volume_of_.clear();
  }
  /// The rows of supports, and their springs on the mean displacement of a face.
  void add_supports();
  /// The mass of the trial functions times `factor` [1/s^2].
  void add_mass(double factor, std::span<const double> density);
  /// On the diagonals of nodes, one value an unknown node; empty: none.
  void add_diagonals(std::span<const double> of_nodes);
  /// Blocks between places times `factor`.
  void add_places(double factor, std::span<const PlaceBlock> blocks);
  /// Of |diagonal blocks|, their first entry. Collective.
  double mean_diagonal() const;
  /// `n_blocks`: of this rank. Collective.
  linalg::SparseMatrix matrix(std::size_t n_blocks) const;

 private:
  using Pair = std::pair<GlobalIndex, GlobalIndex>;
  using VolumeTerms = std::vector<std::pair<GlobalIndex, Vec3>>;
  void add_squares(VolumeTerms& terms, double modulus);
  template <int D>
  void add_lumped(double factor, std::span<const double> density);
  Index node_of(Index f) const { return mesh_.cells.n_local() + f - mesh_.n_interior; }
  Tensor3 open_part(Index node) const;

  const mesh::Mesh& mesh_;
  const mesh::Geometry& geometry_;
  const ElasticOperator& rows_;
  const Numbering& number_;
  FaceTerms terms_;
  std::unordered_map<std::uint64_t, std::size_t> slot_of_;  // of a pair
  std::vector<Pair> pairs_;
  std::vector<Tensor3> blocks_;
  std::map<Index, VolumeTerms> volume_of_;  // of cells
};

}  // namespace couplet::elastic
