// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <span>
#include <vector>

#include "common/elasticity/elasticity.hpp"
#include "common/mesh/mesh.hpp"

namespace couplet::elastic {

/// Rows of a face: gradient as a sum over nodes and points, G = sum_i u_i b_i^T, entry (k, j) = d u_k / d x_j.
struct FaceRows {
  struct Row {
    Index place;  ///< local node (cells, then boundary faces), or n_node_places() + local point
    Vec3 b;       ///< [1/m]; for a ring d/dr, d/dz, and hoop strain per radial displacement
  };
  std::array<Row, 6> row;  ///< owner, neighbor node, then points
  int n;
  double volume;          ///< weight of the face in the energy [m^3]; 2 pi r_m A for a ring
  bool is_ring = false;   ///< body of revolution
  bool has_shear = true;  ///< false at a symmetry plane or the axis of a ring: only the diagonal of G matters
  std::span<const Row> all() const { return {row.data(), std::size_t(n)}; }
};

/// Number of local nodes. Point v is location n_node_places() + v.
inline Index n_node_places(const mesh::Mesh& mesh) { return mesh.cells.n_local() + mesh.boundary.n_local(); }

/// Rows of a 2-D or 3-D face, exact for linear fields on any face: Green-Gauss over the double pyramid of the
/// nodes P, Q and the face (equal to fv::FaceGradient on flat faces),
///   G = [(u_Q - u_P) S^T + sum_i (u_plus_i - u_minus_i) c_i^T] / (S . d)
/// with d = x_Q - x_P. In 2-D, d_0 is the difference of the vertices and c is d rotated by a right angle. In
/// 3-D, d_0 and d_1 are the diagonals of a quadrilateral or two sides of a triangle, and S = d_0 x d_1 / 2,
/// c_0 = d_1 x d / 2, c_1 = d x d_0 / 2 are the cofactors of [d_0, d_1, d]. The volume is V = S . d / dim. At
/// a symmetry plane Q is the mirror image of P, and half of the energy belongs to the body. Rows 2 + 2 i and
/// 3 + 2 i are those of plus_i and minus_i = -plus_i; the owner's row is that of Q with opposite sign.
FaceRows symmetric_rows(const mesh::Mesh& mesh, const ElasticOperator& rows, Index f);

/// Rows of a face of a body of revolution with radius r = x and axis y. Gauss's theorem over the
/// quadrilateral of the nodes P, Q and the vertices, with linear values along its sides, gives
///   int r du/dz = sum of sides (int r u n_z),   int (r du/dr + u) = sum of sides (int r u n_r)
/// and with the value u_m at its centroid r_m and its area A
///   du/dz = sum (int r u n_z) / (r_m A),   du/dr + h = sum (int r u n_r) / (r_m A),   h = u_m / r_m
/// Exact for linear fields. A constant stress with equal radial and hoop parts gives no inner force on any
/// cells. At a symmetry plane and at the axis the triangle of cell and vertices is used, with zero shear.
FaceRows ring_rows(const mesh::Mesh& mesh, const ElasticOperator& rows, Index f);

inline FaceRows face_rows(const mesh::Mesh& mesh, const ElasticOperator& rows, Index f) {
  return is_axisymmetric(rows) ? ring_rows(mesh, rows, f) : symmetric_rows(mesh, rows, f);
}

/// Circumference 2 pi r [m], by which quantities per unit depth become those of the whole ring.
double circumference(double radius);

/// Weights that distribute a uniform load on a face to its points. They sum to 1, and their mean position is
/// the face center. Computed from the triangles between center and edges.
std::array<double, 4> point_shares(const mesh::Mesh& mesh, const mesh::Geometry& geometry, Index f);

/// V_fP of the two sides [m^3]: pyramids from the cell center over the face. The second is 0 on the boundary.
std::array<double, 2> pyramids(const mesh::Mesh& mesh, const mesh::Geometry& geometry, Index f);
/// take(cell, volume of its pyramid) for the owned cells beside a flux face.
template <class Take>
void visit_sides(const mesh::Mesh& mesh, const mesh::Geometry& geometry, Index f, const Take& take) {
  const Index n = mesh.cells.n_owned();
  const auto [here, there] = pyramids(mesh, geometry, f);
  if (mesh.owner[f] < n) take(mesh.owner[f], here);
  if (f < mesh.n_interior && mesh.neighbour[f] < n) take(mesh.neighbour[f], there);
}
/// take(cell, face, volume of its pyramid) for all of them.
template <class Take>
void visit_pyramids(const mesh::Mesh& mesh, const mesh::Geometry& geometry, const Take& take) {
  for (Index f = 0; f < mesh.n_flux_faces(); ++f)
    visit_sides(mesh, geometry, f, [&](Index c, double volume) { take(c, f, volume); });
}

/// Global numbers of the blocks of `dim` unknowns, negative for known values.
struct Numbering {
  std::vector<GlobalIndex> node;   ///< per local node: cells, then boundary faces
  std::vector<GlobalIndex> point;  ///< per local point; empty if resolved into nodes
};

/// Term of a gradient G = sum_i (T_i u_i) b_i^T, entry (k, j) = d u_k / d x_j.
struct FaceTerm {
  GlobalIndex block;  ///< number of u_i
  Vec3 b;             ///< [1/m]
  Tensor3 turn;       ///< T: identity, projector or mirror; e_z e_r^T for a hoop strain
};
using FaceTermList = std::vector<FaceTerm>;

/// Adds a term to the list, merged with one of the same block and `turn`.
void add_term(FaceTermList& terms, const FaceTerm& term);

/// Expresses the rows of faces by numbered unknowns without known values. A list is valid until the next
/// call.
class FaceTerms {
 public:
  /// Keeps references to all arguments.
  FaceTerms(const mesh::Mesh& mesh, const ElasticOperator& rows, const Numbering& number)
      : mesh_(mesh), rows_(rows), number_(number) {}

  /// Gradient at a flux face.
  const FaceTermList& of_face(const FaceRows& face);
  const FaceTermList& of_face(Index f) { return of_face(face_rows(mesh_, rows_, f)); }
  /// Mean displacement of a boundary face by the test functions, u = sum_i b_x T_i u_i.
  const FaceTermList& of_mean(Index f);
  /// Displacement of a point, u = sum_i b_x T_i u_i. Empty if it is fixed.
  const FaceTermList& of_point(Index v);

 private:
  void take_node(Index node, const Vec3& b);
  void take_point(Index v, const Vec3& b);
  void take(GlobalIndex block, const Vec3& b, const Tensor3& turn);

  const mesh::Mesh& mesh_;
  const ElasticOperator& rows_;
  const Numbering& number_;
  const FaceRows* ring_ = nullptr;  // set while the rows of a ring are processed
  FaceTermList terms_;
};

}  // namespace couplet::elastic
