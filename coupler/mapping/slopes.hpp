// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <memory>
#include <vector>

#include "common/coupling/participant.hpp"
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

}  // namespace couplet::coupler
