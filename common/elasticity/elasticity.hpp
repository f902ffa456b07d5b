// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "common/base/types.hpp"
#include "common/elasticity/anisotropic.hpp"
#include "common/elasticity/elastic_boundary.hpp"
#include "common/fv/gradients.hpp"
#include "common/fv/vertex_interpolation.hpp"
#include "common/linalg/matrix.hpp"
#include "common/mesh/mesh.hpp"

namespace couplet::elastic {

/// Material of the operator. `lame` has one entry, or one per local cell (ghosts included).
/// `material_of_cell` is per local cell, or empty for one material. Faces between materials must be bonded.
struct ElasticBody {
  std::vector<LameConstants> lame;
  std::vector<int> material_of_cell;
  VolumeStrain volume_strain = VolumeStrain::faces;  ///< for the symmetric gradient
  bool axisymmetric = false;  ///< body of revolution with radius x; symmetric gradient only
  /// Elastic matrices for the symmetric gradient, or empty. `lame` is then their isotropic mean.
  /// `matrix_of_cell` is the index per local cell, or empty if there is one matrix.
  std::vector<ElasticMatrix> matrix{};
  std::vector<Index> matrix_of_cell{};
};

/// Divergence of the linear-elastic stress on cells and boundary faces: thesis (2.56)-(2.58) and (2.77) (with
/// errata), with all displacement components coupled, in the reference configuration.
///
/// Unknown nodes of a rank are its owned cells, then its boundary faces with an unknown (unknown_faces()) in
/// face order, with `dim` unknowns per node. Both sides of a shared face use the unknown and row of the side
/// with the smaller boundary_id. Known columns are points with a known value, then faces of owned cells with
/// a vector g, in face order. Vertex values are u_V = F_V sum_i w_i u_i + g_V with weights of
/// VertexInterpolation and F_V, g_V of VertexConstraints.
///
/// Row of a cell, [A u + K g] = - sum_f [...] with P, R, k of BoundaryRow at face f (n out of the cell, S its
/// area):
///   interior                                       sigma_f . n S
///   boundary                                       R sigma_f . n S - (I - P) k S (u_B - g); mirrored: u_B.n = 0
/// Row of a face with an unknown:
///   own                                            (I - P) [sigma_f . n S + k S (u_B - g)] + s P (u_B - g)
///   level                                          (2 mu + lambda) S n . grad u
///   shared                                         sigma_f . n S + sigma_f' . n' S, of the two sides
/// with s = (2 mu + lambda) S / (d . n). Known forces go to the right-hand side of the face and cell rows
/// (add_forces()).
class ElasticOperator {
 public:
  /// Keeps references to mesh and geometry.
  ElasticOperator(const mesh::Mesh& mesh, const mesh::Geometry& geometry, const ElasticBoundary& boundary,
                  ElasticBody body);
  /// Operator with one row per patch and one material. Collective.
  ElasticOperator(const mesh::Mesh& mesh, const mesh::Geometry& geometry,
                  std::span<const BoundaryRow> of_patches, const LameConstants& lame);

  const fv::VertexInterpolation& vertices() const { return vertices_; }
  const VertexConstraints& constraints() const { return constraints_; }
  /// Configuration on which the rows are assembled.
  const mesh::Geometry& geometry() const { return *geometry_; }
  const ElasticBoundary& boundary() const { return boundary_; }
  /// Face indices of owned cells' faces with an unknown of their own. Entry i is unknown node n_owned cells +
  /// i.
  const std::vector<Index>& unknown_faces() const { return unknown_faces_; }
  /// Face indices of owned cells' faces with a known column. Entry i is column constraints().points().size()
  /// + i.
  const std::vector<Index>& known_faces() const { return known_faces_; }
  std::size_t n_known() const { return constraints_.points().size() + known_faces_.size(); }
  /// Known column of a boundary face (face index), or -1.
  Index known_of_face(Index face) const { return known_of_face_[face - mesh_->n_interior]; }
  /// Number of unknowns of this rank.
  std::size_t n_unknowns() const { return (mesh_->cells.n_owned() + unknown_faces_.size()) * mesh_->dim; }
  /// Row of a boundary face.
  const BoundaryRow& at(Index face) const { return boundary_[face - mesh_->n_interior]; }
  /// Returns true if the neighbor across the face (of any kind) is the cell's mirror image.
  bool mirrored(Index face) const { return face >= mesh_->n_interior && at(face).mirrored; }
  VolumeStrain volume_strain() const { return body_.volume_strain; }
  /// Returns true if some or all of the bulk modulus acts on the volume strain of cells.
  bool volume_by_cells() const { return body_.volume_strain != VolumeStrain::faces; }
  friend bool is_axisymmetric(const ElasticOperator& rows) { return rows.body_.axisymmetric; }
  /// Returns true if all cells have the same constants.
  bool is_uniform() const { return body_.lame.size() == 1; }
  const LameConstants& lame(Index cell) const { return body_.lame[body_.lame.size() == 1 ? 0 : cell]; }
  /// Returns true if elastic_matrix() gives the stress. lame() is then an isotropic mean.
  bool is_anisotropic() const { return !body_.matrix.empty(); }
  const ElasticMatrix& elastic_matrix(Index cell) const {
    return body_.matrix[body_.matrix_of_cell.empty() ? 0 : body_.matrix_of_cell[cell]];
  }

  /// Replaces the constants, one per local cell (ghosts included), and discards the assembled matrix.
  void set_lame(std::vector<LameConstants> lame);

  /// Matrix with `inertia[c]` added on the diagonal of owned cell c, unless it is empty. Collective.
  linalg::SparseMatrix matrix(std::span<const double> inertia) const;
  /// Subtracts K known from `rhs`. `known` has dim values per known column.
  void subtract_known(std::span<const double> known, std::span<double> rhs) const;
  /// Adds (I - R) of the known forces [N] on boundary faces of owned cells (`dim` values per face). Returns
  /// the sum that this rank added to its cells.
  Vec3 add_forces(std::span<const double> forces, std::span<double> rhs) const;

  /// Adds an isotropic stress - p I with p [Pa] per local face (ghost boundary included): sigma becomes sigma
  /// - p I.
  void add_pressure(std::span<const double> pressure, std::span<double> rhs) const;

  /// Sets the known part P g on boundary faces of owned cells (`faces`: dim values per local boundary face).
  void impose_known(std::span<const double> known, std::span<double> faces) const;
  /// Copies the value of a bonded face's first side to the second. The ghosts of `faces` must be up to date.
  void join_twins(std::span<double> faces) const;

  /// Stress for a displacement gradient in a cell or at one of its faces.
  Tensor3 stress(Index cell, const Tensor3& gradient) const;
  /// Reaction force [N] on a boundary face: R sigma . n S minus that of the springs, or zero on a shared
  /// face. `known` is in column order.
  Vec3 holding_force(Index face, const Tensor3& stress, std::span<const double> faces,
                     std::span<const double> known) const;

 private:
  struct BlockRow;
  void sort_boundary();
  void assemble() const;
  void add_cell(Index cell, std::span<const Index> faces, BlockRow& row) const;
  /// Geometric coefficients of the gradient at a face, with c_V as in FaceGradient.
  struct FaceWeights {
    fv::FaceLine line;
    std::array<Vec3, 4> tangential;
  };
  FaceWeights weights_of(Index face) const;
  void add_unknown_face(Index face, BlockRow& row) const;
  void add_flux(Index face, const Tensor3& scale, BlockRow& row) const;
  void add_vertex(Index point, const Tensor3& block, BlockRow& row) const;
  void add_face_node(Index face, const Tensor3& block, BlockRow& row) const;
  void store(Index unknown_node, BlockRow& row) const;
  LameConstants lame_at(Index face) const;
  double area(Index face) const { return geometry_->face_area[face].norm(); }

  const mesh::Mesh* mesh_;
  const mesh::Geometry* geometry_;
  ElasticBoundary boundary_;
  ElasticBody body_;
  fv::VertexInterpolation vertices_;
  VertexConstraints constraints_;
  std::vector<Index> unknown_faces_, known_faces_;
  std::vector<Index> known_of_face_;  // column, -1 if there is none (or not needed here)
  std::vector<GlobalIndex> number_;   // of each local node as unknown, or -1

  /// Matrix triplets with the positions of the cell rows' diagonals, and known columns as dim x dim blocks.
  /// Assembled on first use.
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

/// Force [N] with its moment about the origin [N m].
struct Wrench {
  Vec3 force = Vec3::Zero(), moment = Vec3::Zero();
  void add(const Vec3& part, const Vec3& place) {
    force += part;
    moment += place.cross(part);
  }
  Vec3 moment_about(const Vec3& centre) const { return moment - centre.cross(force); }
};

}  // namespace couplet::elastic
