// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "common/elasticity/elasticity.hpp"
#include "common/elasticity/symmetric/axisymmetric_faces.hpp"
#include "common/elasticity/symmetric/symmetric_faces.hpp"

namespace couplet::elastic {

/// The nodes of a symmetric face gradient, vertices resolved: G = sum_i (T_i u_i) b_i^T, entry (k, j) =
/// d u_k / d x_j. Nodes whose value is known are left out.
class FaceStencil {
 public:
  struct Term {
    Index node;    ///< local cells, then boundary faces
    Vec3 b;        ///< [1/m]
    Tensor3 turn;  ///< T: I, a projector, a mirror
  };

  /// `number`: of each local node as unknown, negative: known. All by reference.
  FaceStencil(const mesh::Mesh& mesh, const ElasticOperator& rows, const std::vector<GlobalIndex>& number)
      : mesh_(mesh), geometry_(rows.geometry()), rows_(rows), number_(number) {}

  /// Of a flux face; valid until the next call.
  template <int D>
  const std::vector<Term>& of(const SymmetricFace<D>& face, Index f);
  /// Of a body of revolution: b is (d/dr, d/dz, hoop); without shear at a plane of symmetry.
  const std::vector<Term>& of_revolution(const AxisymmetricFace& face, Index f);
  /// Of the mean displacement on a boundary face by the trial functions, u = sum_i b_x T_i u_i; valid until the next call.
  template <int D>
  const std::vector<Term>& of_mean(Index f);
  /// Of a point, u = sum_i b_x T_i u_i; none where it is fixed; valid until the next call.
  const std::vector<Term>& of_point(Index v);
  Index node_of(Index f) const { return mesh_.cells.n_local() + f - mesh_.n_interior; }

 private:
  void take(Index node, const Vec3& b, const Tensor3& turn);
  void take_boundary(Index f, const Vec3& b);
  void take_point(Index v, const Vec3& b);

  const mesh::Mesh& mesh_;
  const mesh::Geometry& geometry_;
  const ElasticOperator& rows_;
  const std::vector<GlobalIndex>& number_;
  std::vector<Term> terms_;
};

}  // namespace couplet::elastic
