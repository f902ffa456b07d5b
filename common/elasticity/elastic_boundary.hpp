// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "common/base/types.hpp"
#include "common/mesh/mesh.hpp"

namespace couplet::elastic {

/// What a condition gives to the rows of a boundary face, as numbers. With the projector P, the stiffness k of springs, the
/// known vector g of the face (displacement along P, place of the far end of the springs across) and a known traction T:
///   P (u_B - g) = 0,   (I - P) [sigma . n + k (u_B - g) - T] = 0
/// Nothing else is asked of a condition but where u_B is no unknown of the face alone (mirrored, level, shared).
struct BoundaryRow {
  Tensor3 known = Tensor3::Zero();   ///< P, symmetric: 0 free, I fixed, n n^T across a plane
  Tensor3 spring = Tensor3::Zero();  ///< k, symmetric [N/m^3]
  /// R: the cell takes R sigma . n as it is and (I - R) T; P, or I if level or shared.
  Tensor3 passing = Tensor3::Zero();
  bool fixed = false;     ///< P = I: no unknown
  bool held = false;      ///< P is not 0
  bool mirrored = false;  ///< no unknown: across the face stands the mirror image of the cell
  bool level = false;     ///< n . grad u = 0 is the row of u_B, thesis (2.62)
  bool shared = false;    ///< between two materials; both sides have the same u_B
  bool operator==(const BoundaryRow&) const = default;

  /// All of the force on it is known.
  bool is_free() const { return !mirrored && passing.isZero(0) && spring.isZero(0); }
  /// It has a vector g.
  bool has_value() const { return !mirrored && (held || !spring.isZero(0)); }
};

BoundaryRow free_row();
BoundaryRow fixed_row();
/// P and k as above.
BoundaryRow support_row(const Tensor3& known, const Tensor3& spring);
/// A plane of symmetry. P comes with the geometry.
BoundaryRow mirror_row();
BoundaryRow level_row();

/// The row of each local boundary face (entry of mesh.boundary, ghosts included).
class ElasticBoundary {
 public:
  /// `row`: of the next entry.
  void add(const BoundaryRow& row);
  const BoundaryRow& operator[](Index entry) const { return rows_[row_of_face_[entry]]; }
  Index size() const { return static_cast<Index>(row_of_face_.size()); }
  /// P = n n^T of the mirrors; faces between materials are shared whatever was given.
  ElasticBoundary on(const mesh::Mesh& mesh, const mesh::Geometry& geometry) const;

 private:
  std::vector<BoundaryRow> rows_;  // few: runs of equal ones are one
  std::vector<Index> row_of_face_;
};

/// One row a patch.
ElasticBoundary boundary_of_patches(const mesh::Mesh& mesh, std::span<const BoundaryRow> of_patches);

}  // namespace couplet::elastic
