// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <span>
#include <vector>

#include "common/elasticity/elasticity.hpp"
#include "common/mesh/mesh.hpp"

namespace couplet::elastic {

/// The rows of a face: its gradient as a sum over nodes and points, G = sum_i u_i b_i^T, entry (k, j) = d u_k / d x_j.
struct FaceRows {
  struct Row {
    Index place;  ///< local node (cells, then boundary faces), or n_node_places() + local point
    Vec3 b;       ///< [1/m]; for a ring d/dr, d/dz, and the factor from radial displacement to hoop strain
  };
  std::array<Row, 6> row;  ///< the owner, the node across, then the points
  int n;
  double volume;          ///< weight of the face in the energy [m^3]; 2 pi r_m A for a ring
  bool is_ring = false;   ///< of a body of revolution
  bool has_shear = true;  ///< false at a symmetry plane or the axis of a ring: only the diagonal of G counts
  std::span<const Row> all() const { return {row.data(), std::size_t(n)}; }
};

/// Number of local nodes: the place of point v is n_node_places() + v.
inline Index n_node_places(const mesh::Mesh& mesh) { return mesh.cells.n_local() + mesh.boundary.n_local(); }

/// Rows of a two- or three-dimensional face, exact for linear fields on any face: Green-Gauss over the double pyramid of the
/// two nodes P, Q and the face (equal to fv::FaceGradient on flat faces),
///   G = [(u_Q - u_P) S^T + sum_i (u_plus_i - u_minus_i) c_i^T] / (S . d)
/// with d = x_Q - x_P, and d_i the one difference of vertices (2-D) or the two (3-D: the diagonals of a
/// quadrilateral, two sides of a triangle): S = d_0 x d_1 / 2, c_0 = d_1 x d / 2, c_1 = d x d_0 / 2 are the
/// cofactors of [d_0, d_1, d]. In the plane c is d turned by a right angle. The volume between the nodes is V
/// = S . d / dim. At a symmetry plane Q is the mirror image of P, and half of the pyramids' energy is the body's.
/// Rows 2 + 2 i and 3 + 2 i are those of plus_i and minus_i = -plus_i; the owner's is that of Q with the other sign.
FaceRows symmetric_rows(const mesh::Mesh& mesh, const ElasticOperator& rows, Index f);

/// Rows of a face of a body of revolution, x being the radius r and y the axis. Over the quadrilateral of the two nodes P, Q
/// beside the face and its vertices, with values that are linear along its sides, Gauss's theorem says
///   integral of r du/dz = sum of sides (int r u n_z),   integral of (r du/dr + u) = sum of sides (int r u n_r),
/// and with u_m, the value at the centroid r_m of the quadrilateral, of area A,
///   d u/dz = sum (int r u n_z) / (r_m A),   h = u_r / r = u_m / r_m,   du/dr + u_m / r_m = sum (int r u n_r) / (r_m A).
/// Exact for linear fields; a constant stress with equal radial and hoop parts leaves no force inside, on any cells. At a
/// plane of symmetry and at the axis the triangle of the cell with the vertices counts, where shear across is zero.
FaceRows ring_rows(const mesh::Mesh& mesh, const ElasticOperator& rows, Index f);

inline FaceRows face_rows(const mesh::Mesh& mesh, const ElasticOperator& rows, Index f) {
  return is_axisymmetric(rows) ? ring_rows(mesh, rows, f) : symmetric_rows(mesh, rows, f);
}

/// 2 pi r [m]. Quantities of a two-dimensional scene are per unit depth; this factor makes them those of the whole ring.
double circumference(double radius);

/// Shares with which the points around a face, in their order, take what acts on it evenly: they add up to 1
/// and their mean place is the face centre. By the triangles between the centre and the edges.
std::array<double, 4> point_shares(const mesh::Mesh& mesh, const mesh::Geometry& geometry, Index f);

/// V_fP of the two sides [m^3]: pyramids from the cell's centre over the face; the second is 0 on the
/// boundary.
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
