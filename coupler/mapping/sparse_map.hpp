// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <mpi.h>
#include <Eigen/Core>

#include <span>
#include <string>
#include <vector>

#include "common/base/types.hpp"
#include "common/coupling/participant.hpp"
#include "coupler/exchange/side.hpp"
#include "coupler/exchange/transfer.hpp"

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

/// Weights of the sources for the value at x: the interpolant by Wendland's compact C2 function
/// phi(r) = (1 - r/R)^4 (4 r/R + 1) on these sources, with a linear polynomial [Wendland 1995; de Boer et al.
/// 2007]. They sum to 1 and carry linear fields exactly. The polynomial is taken in the directions in which
/// the sources spread, so that points on a line or in a plane are no trouble; across these the value is
/// constant, and also where x lies far from the sources in a direction in which these hardly spread. One
/// source: its value.
std::vector<double> local_weights(const std::vector<Vec3>& points, std::span<const Index> sources,
                                  const Vec3& x);

/// Each target takes the value at its nearest point of the surface: linear along edges (2-D) and over the
/// triangles of faces (3-D; a face of more corners is cut into triangles about its centre). Beside the
/// surface's end the value of the end counts. `vertices`, `rows`: positions of vertices and targets in their lists.
void add_projection(const coupling::Interface& surface, const std::vector<GlobalIndex>& vertices,
                    const std::vector<Vec3>& targets, const std::vector<GlobalIndex>& rows,
                    std::vector<Transfer::Entry>& entries);

/// The faces that add_projection looks at: the nearest face touches one of so many nearest vertices, or is large and
/// has its centre among so many nearest ones.
inline constexpr std::size_t projection_vertices = 3, projection_faces = 4;
/// Number of faces with nearest centers to choose from if no face covers a place.
inline constexpr std::size_t nearest_faces = 9;

/// Distance [m] of a place from a face with known corners.
double distance_to_face(const coupling::Interface& surface, Index face, const Vec3& place);

/// Each target takes the local interpolant through the k nearest of `among` on any rank. Collective.
void add_interpolation(MPI_Comm comm, const PointSet& among, const std::vector<Vec3>& targets,
                       const std::vector<GlobalIndex>& rows, std::size_t k,
                       std::vector<Transfer::Entry>& entries);

/// Throws Error with the participant if its corners are listed incorrectly. `vertices`: number on all ranks.
void check_corners(const coupling::Interface& surface, const std::string& name, GlobalIndex vertices);

/// Map between a structure and a surface that moves with it and gives its load, used in both directions:
///   motion: B N A,   load: transpose of B N
/// A takes means of the motion over the structure's faces, N maps these to the surface's vertices, and B
/// takes means over the surface's faces. Without listed corners, N takes local interpolants. The work of the load on the mean motion is then equal on both sides
/// to round-off for any meshes. N is exact for linear fields, so the load keeps its force and moment. A is
/// omitted for motion given at faces, B for a load given at vertices. A load taken at vertices uses the
/// transpose of A. Collective; both sides must outlive it.
class ConjugateMap {
 public:
  using Place = coupling::Interface::Place;
  using Entries = std::vector<Transfer::Entry>;
  ConjugateMap(MPI_Comm comm, const Side& structure, const Side& surface);
  /// Motion from the structure to the surface.
  Entries motion(Place from, Place to) const;
  /// Load from the surface to the structure.
  Entries load(Place from, Place to) const;

 private:
  /// N with A and B as required by the places.
  Entries between(Place structure, Place surface) const;
  MPI_Comm comm_;
  const Side *structure_, *surface_;
  Entries to_faces_, across_, to_surface_faces_;  // A, N, B
};

/// Part of a face that a face of the other surface covers: integrals over it of products of the face's corner
/// functions [m^2] (2-D: [m]). Each is 1 at its corner and linear along an edge (2-D) or over the triangles
/// of the face, which meet at the mean of the corners for more than three.
struct Cover {
  Index other;
  Eigen::MatrixXd products;
};

/// Cover of `face` by the faces of `other` among `candidates`, projected along its normal. Only faces that
/// look against it count, and of several layers the nearest. Uncovered parts go to the nearest face. The
/// products then sum to those over the whole face, except where a fold hides or duplicates something.
std::vector<Cover> covers(const coupling::Interface& surface, Index face, const coupling::Interface& other,
                          const std::vector<Index>& candidates);

}  // namespace couplet::coupler
