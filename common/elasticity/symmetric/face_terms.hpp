// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "common/elasticity/elasticity.hpp"
#include "common/elasticity/symmetric/symmetric_faces.hpp"

namespace couplet::elastic {

/// Numbers of the blocks of `dim` unknowns; negative: known, or none.
struct Numbering {
  std::vector<GlobalIndex> node;   ///< of local nodes: cells, then boundary faces
  std::vector<GlobalIndex> point;  ///< of local points; empty: a point is the mean of the nodes around it
};

/// A part of a gradient: G = sum_i (T_i u_i) b_i^T, entry (k, j) = d u_k / d x_j.
struct FaceTerm {
  GlobalIndex block;  ///< of u_i
  Vec3 b;             ///< [1/m]
  Tensor3 turn;       ///< T: I, a projector, a mirror; of a hoop strain e_z e_r^T
};
using FaceTermList = std::vector<FaceTerm>;

/// Adds a term to those of the same block and turn.
void add_term(FaceTermList& terms, const FaceTerm& term);

/// The rows of faces by the blocks of their unknowns, what is known left out. A list is valid until the next call.
class FaceTerms {
 public:
  /// All by reference.
  FaceTerms(const mesh::Mesh& mesh, const ElasticOperator& rows, const Numbering& number)
      : mesh_(mesh), rows_(rows), number_(number) {}

  /// Of the gradient at a flux face.
  const FaceTermList& of_face(const FaceRows& face);
  const FaceTermList& of_face(Index f) { return of_face(face_rows(mesh_, rows_, f)); }
  /// Of the mean displacement on a boundary face by the trial functions, u = sum_i b_x T_i u_i.
  const FaceTermList& of_mean(Index f);
  /// Of a point, u = sum_i b_x T_i u_i; none where it is fixed.
  const FaceTermList& of_point(Index v);

 private:
  void take_node(Index node, const Vec3& b);
  void take_point(Index v, const Vec3& b);
  void take(GlobalIndex block, const Vec3& b, const Tensor3& turn);

  const mesh::Mesh& mesh_;
  const ElasticOperator& rows_;
  const Numbering& number_;
  const FaceRows* ring_ = nullptr;  // while its rows are taken
  FaceTermList terms_;
};

}  // namespace couplet::elastic
