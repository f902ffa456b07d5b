// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "coupler/exchange/side.hpp"
#include "coupler/exchange/transfer.hpp"

namespace couplet::coupler {

/// The interface of a fluid as the wall of a volume: areas of its faces where the wall is, and the volume that it
/// sweeps. A fluid whose mesh rests sees the reference areas wherever its wall is.
class CavityWall {
 public:
  /// Throws Error if the side does not tell the corners of its faces. Collective.
  CavityWall(MPI_Comm comm, const Side& side, bool moves);

  /// Of this rank's faces, out of the fluid [m^2], where the vertices (this rank's) are displaced by
  /// `displacement` [m]; empty: not at all. Collective.
  std::vector<Vec3> areas(const std::vector<double>& displacement) const;
  /// Sum of w . S over this rank's faces, w the mean of a face's corners, and that of |w . S| [m^3/s].
  /// Collective.
  struct Flux {
    double net = 0, size = 0;
  };
  Flux flux(const std::vector<double>& velocity, const std::vector<Vec3>& areas) const;
  /// Volume between two places of the wall, of this rank's faces [m^3]: dx . S, integrated over straight ways
  /// (exact in 2-D and for triangles). Collective.
  double swept(const std::vector<double>& from, const std::vector<double>& to) const;

 private:
  std::vector<double> at_corners(const std::vector<double>& values) const;
  int dim_;
  bool moves_;
  std::size_t n_vertices_;
  std::vector<Index> offset_;
  std::vector<Vec3> corners_, reference_;  // of each face one after the other; areas of the faces
  Transfer to_corners_;
};

}  // namespace couplet::coupler
