// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <mpi.h>

#include <vector>

#include "coupler/exchange/side.hpp"

namespace couplet::coupler {

/// Points requested by a rank from a distributed list, by position.
struct Nearby {
  std::vector<Vec3> points;
  std::vector<GlobalIndex> positions;  ///< ascending, each once
};

/// Returns points of `among` (on any rank) that are among the `k` nearest of a center on this rank, or
/// equally far (to rounding) as the k-th. With `reach` [m] it adds all points nearer than the k-th plus twice
/// the center's reach, which includes the k nearest of every place within reach. Each center asks the ranks
/// with the nearest boxes for a bound, then the ranks whose boxes are within it. Collective.
Nearby nearby(MPI_Comm comm, const std::vector<Vec3>& centres, const std::vector<double>& reach,
              std::size_t k, const PointSet& among);

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
  /// These faces (positions, ascending) with their vertices.
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
