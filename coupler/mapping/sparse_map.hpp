// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>
#include <vector>

#include "common/base/types.hpp"
#include "common/coupling/participant.hpp"
#include "coupler/exchange/side.hpp"
#include "coupler/exchange/transfer.hpp"

namespace couplet::coupler {

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

/// Throws Error with advice if the corners of the faces are not `known`.
void require_corners(bool known);

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

}  // namespace couplet::coupler
