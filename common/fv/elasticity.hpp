// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "common/base/types.hpp"
#include "common/fv/face_gradient.hpp"
#include "common/fv/vertex_interpolation.hpp"
#include "common/linalg/matrix.hpp"
#include "common/mesh/mesh.hpp"

namespace couplet {

/// What is known of the displacement on a patch.
enum class ElasticCondition {
  traction,    ///< the force is known, the displacement of each face is an unknown
  prescribed,  ///< the displacement is known at faces and vertices
  symmetry,    ///< no displacement across the patch, no shear on it; no unknown
};

/// sigma = mu (grad u + grad u^T) + lambda tr(grad u) I [Pa]. Plane stress: lambda is 2 lambda mu / (lambda +
/// 2 mu).
struct LameConstants {
  double mu = 0, lambda = 0;
};

/// Divergence of the linear-elastic stress on cells and traction faces: thesis (2.56)-(2.58) and (2.77) (with
/// errata), all displacement components coupled, reference configuration.
///
/// Row of a cell:          - sum_f sigma_f . S_f   over its faces that are not traction faces (those bring a
/// known force) Row of a traction face:   sigma_f . S_f Unknown nodes of a rank: its owned cells, then its
/// traction faces patch by patch; `dim` unknowns a node. Known columns: displacement of the points, then of
/// the faces, of prescribed patches (of what this rank needs).
class ElasticOperator {
 public:
  /// `conditions`: one a patch. Collective.
  ElasticOperator(const Mesh& mesh, std::span<const ElasticCondition> conditions, const LameConstants& lame);

  const VertexInterpolation& vertices() const { return vertices_; }
  const FaceGradient& faces() const { return faces_; }
  /// Traction faces of owned cells (face indices): unknown node n_owned cells + i is entry i.
  const std::vector<Index>& traction_faces() const { return traction_faces_; }
  const std::vector<Index>& prescribed_points() const { return prescribed_points_; }
  /// Prescribed faces of owned cells (face indices).
  const std::vector<Index>& prescribed_faces() const { return prescribed_faces_; }
  /// Known column of a point or of a boundary face (face index); -1: none.
  Index known_of_point(Index point) const { return known_of_point_[point]; }
  Index known_of_face(Index face) const { return known_of_face_[face - mesh_->n_interior]; }
  /// Unknowns of this rank.
  std::size_t n_unknowns() const { return (mesh_->cells.n_owned() + traction_faces_.size()) * mesh_->dim; }
  ElasticCondition condition(Index face) const { return condition_of_face_[face - mesh_->n_interior]; }

  /// The matrix with `inertia[c]` added on the diagonal of owned cell c (empty: none). Collective.
  SparseMatrix matrix(std::span<const double> inertia) const;
  /// rhs -= (known columns) known; `known`: dim values for each prescribed point, then for each prescribed
  /// face.
  void subtract_known(std::span<const double> known, std::span<double> rhs) const;

  /// Gradient at a face, entry (i, j) = d u_j / d x_i; packed displacements of cells, boundary faces and
  /// points.
  Tensor3 gradient(Index face, std::span<const double> cells, std::span<const double> boundary,
                   std::span<const double> points) const;
  Tensor3 stress(const Tensor3& gradient) const;

 private:
  struct Row;
  void sort_boundary(std::span<const ElasticCondition> conditions);
  void number_unknowns();
  void assemble();
  void add_face(Index face, double sign, Row& row) const;
  void store(Index unknown_node, const Row& row);

  const Mesh* mesh_;
  LameConstants lame_;
  std::vector<ElasticCondition> condition_of_face_;  // per entry of mesh.boundary
  VertexInterpolation vertices_;
  FaceGradient faces_;
  std::vector<Index> traction_faces_, prescribed_points_, prescribed_faces_;
  std::vector<Index> known_of_point_, known_of_face_;  // column, -1: not prescribed (or not needed) here
  std::vector<GlobalIndex> number_;                    // of each local node as unknown, -1: none

  // Triplets of the matrix, and where the diagonals of the cell rows are among them.
  std::vector<GlobalIndex> row_, column_;
  std::vector<double> value_;
  std::vector<std::int64_t> diagonal_;
  // The known columns: blocks of dim x dim.
  std::vector<std::int64_t> known_offset_{0};
  std::vector<Index> known_column_;
  std::vector<double> known_block_;
};

}  // namespace couplet
