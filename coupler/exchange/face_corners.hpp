// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "coupler/exchange/side.hpp"
#include "coupler/exchange/transfer.hpp"

namespace couplet::coupler {

/// Corners of this rank's faces of a side, in order of the faces, with vertices of any rank.
class FaceCorners {
 public:
  FaceCorners() = default;
  /// Collective.
  FaceCorners(MPI_Comm comm, const Side& side);
  /// False if the participant does not list the corners of its faces. Equal on all ranks.
  bool known() const { return known_; }
  const std::vector<Vec3>& points() const { return points_; }  ///< reference configuration [m]
  Index begin(std::size_t face) const { return offset_[face]; }
  Index end(std::size_t face) const { return offset_[face + 1]; }
  /// Distributes values at vertices to the corners; an empty vector stands for zeros. Collective.
  std::vector<double> values(const std::vector<double>& at_vertices, int components) const;
  const std::vector<Vec3>& reference_areas() const { return areas_; }  ///< out of the participant [m^2]
  /// Face areas out of the participant [m^2] (2-D: edges of 1 m depth) with vertices displaced by
  /// `displacement` [m]. Collective.
  std::vector<Vec3> areas(const std::vector<double>& displacement) const;

 private:
  int dim_ = 3;
  bool known_ = false;
  std::size_t n_vertices_ = 0;
  std::vector<Index> offset_;  // of the corners of each face
  std::vector<Vec3> points_, areas_;
  Transfer to_corners_;
};

/// Interface of a fluid as the wall of a cavity: its flux and swept volume. A fluid with a fixed mesh uses
/// the reference areas.
class CavityWall {
 public:
  /// Throws Error if the side does not list the corners of its faces. Collective.
  CavityWall(MPI_Comm comm, const Side& side, bool moves);

  /// Areas of this rank's faces, out of the fluid [m^2]. Collective.
  std::vector<Vec3> areas(const std::vector<double>& displacement) const {
    return moves_ ? corners_.areas(displacement) : corners_.reference_areas();
  }
  /// Sums over this rank's faces of w . S and |w . S| [m^3/s], with w the mean of a face's corners.
  /// Collective.
  struct Flux {
    double net = 0, size = 0;
  };
  Flux flux(const std::vector<double>& velocity, const std::vector<Vec3>& areas) const;
  /// Volume between two positions of this rank's faces [m^3]: dx . S integrated along straight paths (exact
  /// in 2-D and for triangles). Collective.
  double swept(const std::vector<double>& from, const std::vector<double>& to) const;

 private:
  int dim_;
  bool moves_;
  std::size_t n_values_;  // of a vector at this rank's vertices
  FaceCorners corners_;
};

}  // namespace couplet::coupler
