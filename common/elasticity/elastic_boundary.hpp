// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "common/base/types.hpp"
#include "common/fv/vertex_interpolation.hpp"
#include "common/mesh/mesh.hpp"

namespace couplet::elastic {

/// Contribution of a boundary condition to the rows of a face. With projector P, spring stiffness k, known
/// vector g (displacement along P, position of the spring ends otherwise) and known traction T:
///   P (u_B - g) = 0,   (I - P) [sigma . n + k (u_B - g) - T] = 0
/// No other form of condition exists, unless u_B is not an unknown of its own (mirrored, level, shared).
struct BoundaryRow {
  Tensor3 known = Tensor3::Zero();   ///< P, symmetric: 0 free, I fixed, n n^T for a support normal to a plane
  Tensor3 spring = Tensor3::Zero();  ///< k, symmetric [N/m^3]
  /// R: the cell receives R sigma . n and (I - R) T. R is P, or I if the face is level or shared.
  Tensor3 transmitted = Tensor3::Zero();
  bool fixed = false;     ///< P = I: no unknown
  bool held = false;      ///< P is not 0
  bool mirrored = false;  ///< no unknown: the neighbor across the face is the cell's mirror image
  bool level = false;     ///< n . grad u = 0 is the row of u_B, thesis (2.62)
  bool shared = false;    ///< between two materials, whose sides have the same u_B
  bool operator==(const BoundaryRow&) const = default;

  /// Returns true if the force on the face is known completely.
  bool is_free() const { return !mirrored && transmitted.isZero(0) && spring.isZero(0); }
  /// Returns true if the face has a known vector g.
  bool has_value() const { return !mirrored && (held || !spring.isZero(0)); }
};

BoundaryRow free_row();
BoundaryRow fixed_row();
/// Row with P and k as in BoundaryRow.
BoundaryRow support_row(const Tensor3& known, const Tensor3& spring);
/// Symmetry plane. P is computed from the geometry.
BoundaryRow mirror_row();
BoundaryRow level_row();

/// Rows of the local boundary faces (entries of mesh.boundary, ghosts included).
class ElasticBoundary {
 public:
  /// Appends the row of the next entry.
  void add(const BoundaryRow& row);
  const BoundaryRow& operator[](Index entry) const { return rows_[row_of_face_[entry]]; }
  Index size() const { return static_cast<Index>(row_of_face_.size()); }
  /// Sets P = n n^T on symmetry planes and marks faces between materials as shared.
  ElasticBoundary on(const mesh::Mesh& mesh, const mesh::Geometry& geometry) const;

 private:
  std::vector<BoundaryRow> rows_;  // consecutive equal rows are stored once
  std::vector<Index> row_of_face_;
};

/// Boundary with one row per patch.
ElasticBoundary boundary_of_patches(const mesh::Mesh& mesh, std::span<const BoundaryRow> of_patches);

/// Known displacements at the vertices from the conditions of the surrounding faces:
///   u_V = F_V sum_i w_i u_i + g_V,   F_V = I - Q_V,   g_V = sum_j G_j g_j(x_V)
/// Q_V is the projector on the known directions. g_j is the known vector of boundary face j, evaluated at the
/// vertex, so that g_V = Q_V g_V. The rules apply in this order:
/// - A vertex of a fixed face is known in all directions, from the first fixed face (by patch, then by face).
/// - Supports: each patch, in order, fixes the directions that its faces at the vertex share: eigenvalues of
///   their mean P above 3/4. A curved patch thus keeps its mean normal, and a support of part of a patch ends
///   at the last face of the part. Later patches only add free directions, including oblique ones.
/// - Symmetry planes: no displacement across them.
class VertexConstraints {
 public:
  struct Source {
    Index face;     ///< entry of mesh.boundary
    Tensor3 share;  ///< G_j
  };

  /// Face whose condition knows directions of a point that others have already made known.
  struct Repeated {
    Index point;
    Index face;     ///< entry of mesh.boundary
    Tensor3 along;  ///< projector on these directions
  };

  VertexConstraints(const mesh::Mesh& mesh, const ElasticBoundary& boundary,
                    const fv::VertexInterpolation& vertices);

  /// F_V: I if nothing is known, 0 if everything is.
  const Tensor3& free_part(Index point) const { return free_parts_[free_of_[point]]; }
  bool is_constrained(Index point) const { return free_of_[point] != 0; }
  bool is_fixed(Index point) const { return free_of_[point] == 1; }
  /// Points with a known value g_V (not those only on symmetry planes), ascending. Entry i is column i.
  const std::vector<Index>& points() const { return points_; }
  Index column(Index point) const { return column_[point]; }  ///< -1 if there is no value
  const std::vector<Repeated>& repeated() const { return repeated_; }
  std::span<const Source> sources(Index column) const {
    return {sources_.data() + offset_[column], std::size_t(offset_[column + 1] - offset_[column])};
  }

 private:
  class Known;
  void constrain(Index point, std::span<const Index> faces, const mesh::Mesh& mesh,
                 const ElasticBoundary& boundary, std::span<const Index> patch_of_face,
                 const Tensor3& symmetry);
  void store(Index point, const Known& known);

  std::vector<Index> free_of_;  // per point, index into free_parts_
  std::vector<Tensor3> free_parts_{Tensor3::Identity(), Tensor3::Zero()};
  std::vector<Index> points_, column_;
  std::vector<Index> offset_{0};
  std::vector<Source> sources_;
  std::vector<Repeated> repeated_;
};

}  // namespace couplet::elastic
