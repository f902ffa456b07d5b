// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "common/base/types.hpp"
#include "common/elasticity/anisotropic.hpp"
#include "common/elasticity/elastic_boundary.hpp"
#include "common/elasticity/lame.hpp"
#include "common/elasticity/vertex_constraints.hpp"
#include "common/fv/gradients.hpp"
#include "common/fv/vertex_interpolation.hpp"
#include "common/linalg/matrix.hpp"
#include "common/mesh/mesh.hpp"

namespace couplet::elastic {

/// What the operator is made of. `lame`: one, or one a local cell (ghosts included). `material_of_cell`: per
/// local cell, empty when there is one material; where it changes the faces must be bonded.
struct ElasticBody {
  std::vector<LameConstants> lame;
  std::vector<int> material_of_cell;
  VolumeStrain volume_strain = VolumeStrain::faces;  ///< of the symmetric gradient
  bool axisymmetric = false;  ///< of revolution, x being the radius; symmetric gradient
  /// Symmetric gradient: stress by matrices of its own in place of `lame`, which is then their isotropic mean. Empty:
  /// none. `matrix_of_cell`: which of them, per local cell; empty when there is one.
  std::vector<ElasticMatrix> matrix{};
  std::vector<Index> matrix_of_cell{};
};

/// Divergence of the linear-elastic stress on cells and boundary faces: thesis (2.56)-(2.58) and (2.77) (with
/// errata), all displacement components coupled, reference configuration.
///
/// Unknown nodes of a rank: its owned cells, then its boundary faces with an unknown (unknown_faces()) in the
/// order of the faces; `dim` unknowns a node. The two sides of a shared face have the unknown of the side
/// with the smaller boundary_id, which holds the row. Known columns of a rank: points with a known value,
/// then the faces of owned cells that have a vector g in the order of the faces; `dim` values a column.
///
/// Vertex values: u_V = F_V sum_i w_i u_i + g_V with the weights of VertexInterpolation and F_V, g_V of
/// VertexConstraints.
///
/// Row of a cell, [A u + K g] = - sum_f [...] with P, R, k of BoundaryRow at face f (n out of the cell, S its area):
///   interior                                       sigma_f . n S
///   boundary                                       R sigma_f . n S - (I - P) k S (u_B - g); mirrored: u_B = 0 along n
/// Row of a face with an unknown:
///   own                                            (I - P) [sigma_f . n S + k S (u_B - g)] + s P (u_B - g)
///   level                                          (2 mu + lambda) S n . grad u
///   shared                                         sigma_f . n S + sigma_f' . n' S, of the two sides
/// with s = (2 mu + lambda) S / (d . n). The known forces stand on the right: (I - R) F in the face's row and in its
/// cell's (add_forces()).
class ElasticOperator {
 public:
  /// Mesh and geometry by reference.
  ElasticOperator(const mesh::Mesh& mesh, const mesh::Geometry& geometry, const ElasticBoundary& boundary,
                  ElasticBody body);
  /// One row a patch, one material. Collective.
  ElasticOperator(const mesh::Mesh& mesh, const mesh::Geometry& geometry,
                  std::span<const BoundaryRow> of_patches, const LameConstants& lame);

  const fv::VertexInterpolation& vertices() const { return vertices_; }
  const VertexConstraints& constraints() const { return constraints_; }
  /// Where the body stands that the rows describe.
  const mesh::Geometry& geometry() const { return *geometry_; }
  const ElasticBoundary& boundary() const { return boundary_; }
  /// Faces of owned cells with an unknown of their own (face indices): unknown node n_owned cells + i is
  /// entry i.
  const std::vector<Index>& unknown_faces() const { return unknown_faces_; }
  /// Faces of owned cells with a known column (face indices): column constraints().points().size() + i is
  /// entry i.
  const std::vector<Index>& known_faces() const { return known_faces_; }
  std::size_t n_known() const { return constraints_.points().size() + known_faces_.size(); }
  /// Known column of a boundary face (face index); -1: none.
  Index known_of_face(Index face) const { return known_of_face_[face - mesh_->n_interior]; }
  /// Unknowns of this rank.
  std::size_t n_unknowns() const { return (mesh_->cells.n_owned() + unknown_faces_.size()) * mesh_->dim; }
  /// Of a boundary face.
  const BoundaryRow& at(Index face) const { return boundary_[face - mesh_->n_interior]; }
  /// Across the face stands the mirror image of its cell; any face.
  bool mirrored(Index face) const { return face >= mesh_->n_interior && at(face).mirrored; }
  VolumeStrain volume_strain() const { return body_.volume_strain; }
  /// Cells have a volume strain of their own, on which some or all of the bulk modulus acts.
  bool volume_by_cells() const { return body_.volume_strain != VolumeStrain::faces; }
  friend bool is_axisymmetric(const ElasticOperator& rows) { return rows.body_.axisymmetric; }
  /// One pair of constants for all cells.
  bool is_uniform() const { return body_.lame.size() == 1; }
  const LameConstants& lame(Index cell) const { return body_.lame[body_.lame.size() == 1 ? 0 : cell]; }
  /// Stress is by elastic_matrix(), lame() an isotropic mean of it.
  bool is_anisotropic() const { return !body_.matrix.empty(); }
  const ElasticMatrix& elastic_matrix(Index cell) const {
    return body_.matrix[body_.matrix_of_cell.empty() ? 0 : body_.matrix_of_cell[cell]];
  }

  /// Other constants, one a local cell (ghosts included); what was assembled with the old ones is forgotten.
  void set_lame(std::vector<LameConstants> lame);

  /// The matrix with `inertia[c]` added on the diagonal of owned cell c (empty: none). Collective.
  linalg::SparseMatrix matrix(std::span<const double> inertia) const;
  /// rhs -= K known; `known`: dim values a known column.
  void subtract_known(std::span<const double> known, std::span<double> rhs) const;
  /// Adds (I - R) of the known forces [N] of the boundary faces of owned cells (`dim` values a face) to the right-hand
  /// side; gives the sum of what this rank added to its cells.
  Vec3 add_forces(std::span<const double> forces, std::span<double> rhs) const;

  /// Adds the forces of an isotropic stress - p I beside that of the displacement (`pressure`: p [Pa] per
  /// local face, boundary faces of ghost cells included): the rows' sigma becomes sigma - p I.
  void add_pressure(std::span<const double> pressure, std::span<double> rhs) const;

  /// Sets what is known of the values on boundary faces of owned cells (`faces`: dim a local boundary face): P g.
  void impose_known(std::span<const double> known, std::span<double> faces) const;
  /// Gives the second side of bonded faces the value of the first. The ghosts of `faces` must be up to date.
  void join_twins(std::span<double> faces) const;

  /// Stress for the gradient in a cell (or at one of its faces).
  Tensor3 stress(Index cell, const Tensor3& gradient) const;
  /// Force [N] with which a boundary face is held: R sigma . n S less that of the springs, none where it is shared.
  /// `stress` there, `known` in the order of the columns.
  Vec3 holding_force(Index face, const Tensor3& stress, std::span<const double> faces,
                     std::span<const double> known) const;

 private:
  struct Row;
  void sort_boundary();
  void assemble() const;
  void add_cell(Index cell, std::span<const Index> faces, Row& row) const;
  /// What the gradient at a face takes from the geometry; c_V as FaceGradient has them.
  struct FaceWeights {
    fv::FaceLine line;
    std::array<Vec3, 4> tangential;
  };
  FaceWeights weights_of(Index face) const;
  void add_unknown_face(Index face, Row& row) const;
  void add_flux(Index face, const Tensor3& scale, Row& row) const;
  void add_vertex(Index point, const Tensor3& block, Row& row) const;
  void add_face_node(Index face, const Tensor3& block, Row& row) const;
  void store(Index unknown_node, Row& row) const;
  LameConstants lame_at(Index face) const;
  double area(Index face) const { return geometry_->face_area[face].norm(); }

  const mesh::Mesh* mesh_;
  const mesh::Geometry* geometry_;
  ElasticBoundary boundary_;
  ElasticBody body_;
  fv::VertexInterpolation vertices_;
  VertexConstraints constraints_;
  std::vector<Index> unknown_faces_, known_faces_;
  std::vector<Index> known_of_face_;  // column, -1: none (or not needed) here
  std::vector<GlobalIndex> number_;   // of each local node as unknown, -1: none

  /// Triplets of the matrix and where the diagonals of the cell rows are among them; the known columns as
  /// blocks of dim x dim. Made when first asked for.
  struct Assembled {
    std::vector<GlobalIndex> row, column;
    std::vector<double> value;
    std::vector<std::int64_t> diagonal;
    std::vector<std::int64_t> known_offset{0};
    std::vector<Index> known_column;
    std::vector<double> known_block;
  };
  mutable Assembled assembled_;
};

}  // namespace couplet::elastic
