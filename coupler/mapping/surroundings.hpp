// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <mpi.h>

#include <vector>

#include "coupler/exchange/side.hpp"

namespace couplet::coupler {

/// The points of `among` (any rank's) that are one of the `k` nearest of a centre on this rank, those that are
/// equally far (to rounding) as its k-th, and with `reach` [m] all that are nearer than the k-th and twice this
/// centre's reach: then the k nearest of every place within the reach are there. Each centre asks the ranks whose
/// boxes are nearest for a bound, then those ranks whose boxes lie within it. By position, each once. Collective.
PointSet nearby(MPI_Comm comm, const std::vector<Vec3>& centres, const std::vector<double>& reach,
                std::size_t k, const PointSet& among);

/// For each point of `points` on this rank the nearest of `among` on any rank; of equals the one of the
/// smallest id. Collective.
std::vector<Neighbour> nearest(MPI_Comm comm, const std::vector<Vec3>& points, const PointSet& among);

/// Faces of a surface and their vertices, with positions in the global lists; corners refer to vertices
/// within the part.
struct SurfacePart {
  coupling::Interface surface;
  std::vector<GlobalIndex> vertices, faces;  ///< ascending
};

/// Part of the surface of `set` that this rank needs, from the ranks that own it. Collective.
class Surroundings {
 public:
  /// `part`: this rank's part, with corners by position in the list of vertices. It must outlive this.
  Surroundings(MPI_Comm comm, const coupling::Interface& part);
  bool has_corners() const { return has_corners_; }  ///< on all ranks; false if there are no faces
  PointSet vertices() const;                         ///< this rank's
  PointSet faces() const;
  double widest() const;  ///< largest reach of a face on any rank [m]
  /// Returns the mesh of the faces at `faces` (positions, ascending) with their vertices.
  SurfacePart with(const std::vector<GlobalIndex>& faces) const;
  /// Positions of faces that have one of these vertices (positions, ascending) as a corner, ascending.
  std::vector<GlobalIndex> faces_around(const std::vector<GlobalIndex>& vertices) const;

 private:
  MPI_Comm comm_;
  const coupling::Interface& part_;
  coupling::Starts vertex_starts_, face_starts_;
  bool has_corners_;
};

}  // namespace couplet::coupler
