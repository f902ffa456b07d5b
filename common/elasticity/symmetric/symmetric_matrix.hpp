// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <map>
#include <memory>
#include <span>
#include <unordered_map>
#include <utility>
#include <vector>

#include "common/elasticity/elasticity.hpp"
#include "common/elasticity/symmetric/surface_pressure.hpp"
#include "common/elasticity/symmetric/symmetric_faces.hpp"
#include "common/linalg/matrix.hpp"
#include "common/linalg/symmetric_factors.hpp"

namespace couplet::elastic {

/// Assembled symmetric operator without shared edges: V_f B_f^T C B_f over the faces, springs, rows of
/// supports, and the mass of `inertia` (mass factor times density of owned cells [N/m^4], or empty). It
/// equals the kernel's K + factor M if no face shares, and otherwise preconditions it. For small bodies,
/// since a row in 3-D has about 90 nodes on hexahedra and 200 on tetrahedra. Collective.
linalg::SparseMatrix symmetric_matrix(const mesh::Mesh& mesh, const ElasticOperator& rows,
                                      std::span<const double> inertia);

/// dP/dF or C, entry (3 k + a, 3 m + c): effect of derivative c of component m on the stress (k, a) [Pa].
using GradientStiffness = Eigen::Matrix<double, 9, 9>;

/// Weights of the parts of an assembled operator, stiffness K + mass M + stress K_sigma.
struct EnergyParts {
  double stiffness = 1;
  double mass = 0;                       ///< [1/s^2]
  std::span<const double> density{};     ///< per owned cell [kg/m^3]; for `mass`
  double stress = 0;                     ///< weight of K_sigma, see StressStiffness
  const Prestress* prestress = nullptr;  ///< for `stress`
};

/// Sums blocks between pairs of unknowns and builds a matrix from them. A face of a tetrahedron couples about
/// sixty nodes, and each pair shares many faces. Summing here leaves a fiftieth of the entries for PETSc to
/// sort (a tenth of the time on 1000 tetrahedra).
class Assembly {
 public:
  /// Keeps references to all arguments. Numbers must be below 2^32.
  Assembly(const mesh::Mesh& mesh, const ElasticOperator& rows, const Numbering& number);

  FaceTerms& terms() { return terms_; }
  void add(GlobalIndex i, GlobalIndex j, const Tensor3& block);
  /// Adds sum_ij T_i^T [b_i . stiffness . b_j] T_j for one gradient; `stiffness` includes the volume [N m].
  void add(const FaceTermList& terms, const GradientStiffness& stiffness);
  /// Adds stiffness and stress of the faces of owned cells. If `shares`, triangles in 3-D omit what they
  /// share with their edges, see SharedEdges.
  void add_faces(const EnergyParts& parts, bool shares);
  /// Adds the share of the edges. Collective.
  void add_edges(const EnergyParts& parts);
  /// Adds the bulk modulus that acts on the volume strain of cells.
  void add_volumes(const EnergyParts& parts);
  /// Records that V_P theta_P of the owned cells beside a face changes by V_fP cofactors b . u.
  void add_volume_terms(Index f, const FaceTermList& terms, const Tensor3& cofactors);
  /// Adds modulus(cell) g g^T for the terms collected by add_volume_terms().
  template <class Modulus>
  void finish_volumes(const Modulus& modulus) {
    for (auto& [cell, terms] : volume_of_) add_squares(terms, modulus(cell));
    volume_of_.clear();
  }
  /// Adds the rows of supports, and their springs on the mean displacement of a face.
  void add_supports();
  /// Adds the mass of the test functions times `factor` [1/s^2].
  void add_mass(double factor, std::span<const double> density);
  /// Adds one value per unknown node to the diagonal; empty means none.
  void add_diagonals(std::span<const double> of_nodes);
  /// Adds blocks between locations times `factor`.
  void add_places(double factor, std::span<const PlaceBlock> blocks);
  /// Mean of |first entry| of the diagonal blocks. Collective.
  double mean_diagonal() const;
  /// `n_blocks`: number of block rows of this rank. Collective.
  linalg::SparseMatrix matrix(std::size_t n_blocks) const;

 private:
  using Pair = std::pair<GlobalIndex, GlobalIndex>;
  using VolumeTerms = std::vector<std::pair<GlobalIndex, Vec3>>;
  void add_squares(VolumeTerms& terms, double modulus);
  void add_mean(const FaceTermList& terms, const Tensor3& stiffness);
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

/// Diagonal of the symmetric operator K = sum_f V_f B_f^T C B_f [N/m] for preconditioners. It includes the
/// contributions of the vertices, which dominate and are missing in two-point fluxes.
///
/// Exact if no face shares with edges, the volume strain is that of the faces, and no condition constrains
/// vertices. It neglects sharing, which overestimates it, as well as vertex projectors (a few percent beside
/// symmetry planes), springs and inertia.
struct SymmetricDiagonal {
  std::vector<double> cells;   ///< K_cc of the owned cells, `dim` values each
  std::vector<Tensor3> faces;  ///< blocks K_BB of rows.unknown_faces()
};

/// `without` selects the bulk modulus that the operator lacks (VolumeStrain::faces: none). Collective.
SymmetricDiagonal symmetric_diagonal(const mesh::Mesh& mesh, const ElasticOperator& rows,
                                     VolumeStrain without);

/// Symmetric operator with the rows of ElasticOperator, stored with the vertices as additional unknowns that
/// Lagrange multipliers tie to the means of their nodes. It is as exact as SymmetricKernel, and cheap to
/// factorize: for 2161 tetrahedra it has 2.7e6 entries instead of 1.6e7.
class TiedMatrix {
 public:
  /// Returns false for periodic meshes, whose vertices exist on several ranks at once.
  static bool suits(const mesh::Mesh& mesh);
  /// Keeps references to mesh and rows. Collective.
  TiedMatrix(const mesh::Mesh& mesh, const ElasticOperator& rows, const EnergyParts& parts);

  /// Computes y = A x on the rows of ElasticOperator. Collective.
  void apply(std::span<const double> x, std::span<double> y);
  /// Computes the LDL^T factorization that the following functions need. Throws SolveFailure. Collective.
  void factorise();
  /// Computes y = A^-1 x. Throws SolveFailure. Collective.
  void solve(std::span<const double> x, std::span<double> y);
  /// Number of negative eigenvalues of A, by Sylvester's law of inertia.
  GlobalIndex negative() const { return factors_->negative_pivots() - n_ties_; }

 private:
  void number_all();
  void add_ties(Assembly& assembly) const;
  linalg::SparseMatrix assemble(const EnergyParts& parts);

  const mesh::Mesh& mesh_;
  const ElasticOperator& rows_;
  std::size_t n_nodes_;        // unknown, of this rank; in the order of ElasticOperator
  std::vector<Index> points_;  // owned unknown ones, in the order of their numbers
  Numbering number_;           // rank by rank: nodes, points, a multiplier per point
  GlobalIndex first_multiplier_ = 0;
  double tie_ = 0;
  linalg::SparseMatrix matrix_;
  GlobalIndex n_ties_ = 0;
  std::unique_ptr<linalg::SymmetricFactors> factors_;
  std::vector<double> from_, to_;
};

}  // namespace couplet::elastic
