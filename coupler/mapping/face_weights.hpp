// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include <memory>
#include <span>
#include <vector>

#include "common/base/point_tree.hpp"
#include "common/coupling/participant.hpp"
#include "coupler/exchange/transfer.hpp"
#include "coupler/parameters/parameters.hpp"

namespace couplet::base {
class PointTree;
}

namespace couplet::coupler {

/// The slope of a field along a surface at one of its faces, from values at faces: sum of weights.col(i) times the
/// value at around[i], exact for linear fields as far as these faces span the surface there.
struct Slope {
  std::vector<Index> around;
  Eigen::Matrix3Xd weights;
};

/// Slopes at the faces of a surface, each found when it is first wanted. Neighbours look the same way, so that no
/// slope goes around a corner or through a plate. `projection`: least squares through the faces that share an edge
/// (2-D: a vertex) with it, or, where these do not span the surface, a vertex, at last also around a corner; rbf, and without corners: the local
/// interpolant through the nearest 5 (2-D) or 10 faces, its rise over the face itself.
class Slopes {
 public:
  Slopes(const coupling::Interface& surface, MappingParameters::Type type);
  ~Slopes();
  const Slope& at(Index face);
  /// So many of the faces nearest to a face count for its radial slope.
  static std::size_t looks_at(int dim) { return dim == 2 ? 20 : 40; }

 private:
  Slope least_squares(Index face, const std::vector<Index>& neighbours, bool& spans) const;
  Slope radial(Index face) const;
  std::vector<Index> touching(Index face, std::size_t shared, double least_cosine) const;

  const coupling::Interface& surface_;
  bool radial_;
  std::vector<std::vector<Index>> faces_of_;  // by vertex
  std::vector<Slope> known_;
  std::unique_ptr<base::PointTree> centres_;
};

/// Corners of a face, as positions in the surface's own list of vertices.
std::span<const Index> corners(const coupling::Interface& surface, Index face);

/// Distance of a face's farthest corner from its centre [m].
double reach(const coupling::Interface& surface, Index face);

/// Weights of a face's corners for the mean of a field over the face. They sum to 1 and carry linear fields to
/// the centre that the participant gives: edges and triangles 1/n, faces of more corners by the areas of the
/// triangles about the mean of their corners, with the least change that meets the centre.
std::vector<double> corner_weights(const coupling::Interface& surface, Index face);

/// From values at the vertices to the means over the faces, over the ranks; `part`: this rank's part, corners by
/// position in the list of all vertices. Where the participant does not list corners: local interpolants. Collective.
std::vector<Transfer::Entry> vertices_to_faces(MPI_Comm comm, const coupling::Interface& part);

/// Weights of one source in a row, as the dual functions give them and what they have more than the corner functions
/// themselves: that part sums to nothing over the corners of each face.
struct Weights {
  double dual, more;
};

/// Integrals over one face of a surface of its corner functions and their duals times the structure's field.
class FaceIntegrals {
 public:
  FaceIntegrals(const coupling::Interface& structure, MappingParameters::Type type);
  /// Where the mean over a face of the structure is the value of a linear field.
  const Vec3& mean(Index s) const { return means_[std::size_t(s)]; }

  /// What a face gives to the row of one of its corners.
  struct Part {
    Index corner, source;  ///< a face of the structure
    Weights weights;
  };
  /// Without `dual` the corner functions themselves.
  void find(const coupling::Interface& surface, Index face, bool dual, std::vector<Part>& parts);

 private:
  /// Faces of the structure that may cover one with this centre and reach, ascending.
  std::vector<Index> candidates(const Vec3& centre, double reach) const;

  const coupling::Interface& structure_;
  base::PointTree tree_;
  Slopes slopes_;
  std::vector<Vec3> means_;
  double widest_ = 0;
};

}  // namespace couplet::coupler
