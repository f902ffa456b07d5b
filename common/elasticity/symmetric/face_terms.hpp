// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "common/elasticity/elasticity.hpp"
#include "common/elasticity/symmetric/symmetric_faces.hpp"

namespace couplet::elastic {

/// Global numbers of the blocks of `dim` unknowns. A negative number means that the value is known.
struct Numbering {
  std::vector<GlobalIndex> node;   ///< per local node: cells, then boundary faces
  std::vector<GlobalIndex> point;  ///< per local point; empty: resolved into nodes
};

/// One term of a gradient G = sum_i (T_i u_i) b_i^T, entry (k, j) = d u_k / d x_j.
struct FaceTerm {
  GlobalIndex block;  ///< number of u_i
  Vec3 b;             ///< [1/m]
  Tensor3 turn;       ///< T: identity, projector or mirror; e_z e_r^T for a hoop strain
};
using FaceTermList = std::vector<FaceTerm>;

/// Adds a term to the list, merged with one of the same block and turn.
void add_term(FaceTermList& terms, const FaceTerm& term);

/// Expresses the rows of faces by numbered unknowns; known values are left out. A returned list is valid until
/// the next call.
class FaceTerms {
 public:
  /// Keeps all arguments by reference.
  FaceTerms(const mesh::Mesh& mesh, const ElasticOperator& rows, const Numbering& number)
      : mesh_(mesh), rows_(rows), number_(number) {}

  /// Gradient at a flux face.
  const FaceTermList& of_face(const FaceRows& face);
  const FaceTermList& of_face(Index f) { return of_face(face_rows(mesh_, rows_, f)); }
  /// Mean displacement of a boundary face by the trial functions, u = sum_i b_x T_i u_i.
  const FaceTermList& of_mean(Index f);
  /// Displacement of a point, u = sum_i b_x T_i u_i; empty if it is fixed.
  const FaceTermList& of_point(Index v);

 private:
  void take_node(Index node, const Vec3& b);
  void take_point(Index v, const Vec3& b);
  void take(GlobalIndex block, const Vec3& b, const Tensor3& turn);

  const mesh::Mesh& mesh_;
  const ElasticOperator& rows_;
  const Numbering& number_;
  const FaceRows* ring_ = nullptr;  // set while the rows of a ring are taken
  FaceTermList terms_;
};

}  // namespace couplet::elastic
