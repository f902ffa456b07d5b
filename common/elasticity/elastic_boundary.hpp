// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "common/base/types.hpp"
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
  Tensor3 passing = Tensor3::Zero();
  bool fixed = false;     ///< P = I: no unknown
  bool held = false;      ///< P is not 0
  bool mirrored = false;  ///< no unknown: the neighbor across the face is the cell's mirror image
  bool level = false;     ///< n . grad u = 0 is the row of u_B, thesis (2.62)
  bool shared = false;    ///< between two materials, whose sides have the same u_B
  bool operator==(const BoundaryRow&) const = default;

  /// Returns true if the force on the face is known completely.
  bool is_free() const { return !mirrored && passing.isZero(0) && spring.isZero(0); }
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

}  // namespace couplet::elastic
