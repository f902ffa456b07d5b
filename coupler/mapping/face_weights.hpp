// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include <span>
#include <vector>

#include "common/base/point_tree.hpp"
#include "common/coupling/participant.hpp"
#include "coupler/exchange/transfer.hpp"

namespace couplet::coupler {

/// Slope of a field along a surface at one of its faces: sum of weights.col(i) times the value at around[i].
/// Exact for linear fields if these faces span the surface there.
struct Slope {
  std::vector<Index> around;
  Eigen::Matrix3Xd weights;
};

/// Slopes at the faces of a surface, each computed on first use. Only neighbors of similar orientation are
/// used, so that no slope crosses a corner or a plate: least squares over faces that share an edge (2-D: a
/// vertex), if necessary a vertex, finally also around a corner.
class Slopes {
 public:
  /// `surface`: with corners.
  explicit Slopes(const coupling::Interface& surface);
  const Slope& at(Index face);

 private:
  Slope least_squares(Index face, const std::vector<Index>& neighbours, bool& spans) const;
  std::vector<Index> touching(Index face, std::size_t shared, double least_cosine) const;

  const coupling::Interface& surface_;
  std::vector<std::vector<Index>> faces_of_;  // by vertex
  std::vector<Slope> known_;
};

/// Corners of a face, as positions in the surface's own list of vertices.
std::span<const Index> corners(const coupling::Interface& surface, Index face);

/// Largest distance of a face's corners from its center [m].
double reach(const coupling::Interface& surface, Index face);

/// Weights of a face's corners for the mean of a field over the face. They sum to 1 and give linear fields at
/// the participant's center. Edges and triangles use 1/n, other faces the areas of triangles about the mean
/// of their corners, with the smallest correction that matches the center.
std::vector<double> corner_weights(const coupling::Interface& surface, Index face);

/// Map from vertex values to means over faces, across ranks. `part`: this rank's part, with corners by
/// position in the global list of vertices. Uses local interpolants if corners are not listed. Collective.
std::vector<Transfer::Entry> vertices_to_faces(MPI_Comm comm, const coupling::Interface& part);

/// Weights of one source in a row: those of the dual functions, and their excess over the corner functions,
/// which sums to zero over the corners of each face.
struct DualWeights {
  double dual, more;
};

/// Integrals over a face of its corner functions and their duals times the structure's field.
class FaceIntegrals {
 public:
  explicit FaceIntegrals(const coupling::Interface& structure);
  /// Position at which the mean over a face of the structure equals the value of a linear field.
  const Vec3& mean(Index s) const { return means_[std::size_t(s)]; }

  /// Finds the contributions of a face to the rows of its corners. Without `dual`, uses the corner functions
  /// themselves.
  void find(const coupling::Interface& surface, Index face, bool dual);
  /// Faces of the structure found last, each once, and their weights: n for the n corners of the face.
  const std::vector<Index>& sources() const { return sources_; }
  const std::vector<DualWeights>& weights() const { return weights_; }

 private:
  DualWeights* weights_of(Index source, std::size_t corners);

  const coupling::Interface& structure_;
  base::PointTree tree_;
  Slopes slopes_;
  std::vector<Vec3> means_;
  double widest_ = 0;
  std::vector<Index> place_, sources_;  // place_: in sources_, by face of the structure; -1 elsewhere
  std::vector<DualWeights> weights_;
};

/// Map from faces of `structure` to vertices of `surface`. Each vertex takes the mean of the structure's
/// field, linear over each face, weighted by the function biorthogonal to the corner functions on each face
/// (dual Lagrange multipliers, Wohlmuth 2000). Exact for linear fields; the transpose maps a uniform traction
/// to a uniform one. Both: this rank's parts, with corners. Collective.
std::vector<Transfer::Entry> faces_to_vertices(MPI_Comm comm, const coupling::Interface& structure,
                                               const coupling::Interface& surface);

/// Map to the means over the faces of `surface`, for amounts without a corresponding motion.
std::vector<Transfer::Entry> faces_to_faces(MPI_Comm comm, const coupling::Interface& structure,
                                            const coupling::Interface& surface);

}  // namespace couplet::coupler
