// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "common/coupling/participant.hpp"
#include "coupler/sparse_map.hpp"

namespace couplet {

/// Each target takes the value at its nearest point of the surface: linear along edges (2-D) and over the
/// triangles of faces (3-D; a face of more corners is cut into triangles about its centre). Beside the
/// surface's end the value of the end counts.
SparseMap nearest_projection(const Interface& surface, const std::vector<Vec3>& targets);

/// Throws Error saying what to do where the corners of the faces are not `known`.
void require_corners(bool known);

/// The faces that nearest_projection looks at: the nearest face touches one of so many nearest vertices, or is large and
/// has its centre among so many nearest ones.
inline constexpr std::size_t projection_vertices = 3, projection_faces = 4;

/// Every force at a face is cut into equal parts over the face, as fine as the faces it goes to, and each
/// part is shared out among the `k` nearest of these that look the other way (surfaces face each other), with
/// weights that carry linear fields: the sum of forces and their moment are kept, and no finer face goes
/// without.
SparseMap shared_out(const Interface& from, const Interface& to, std::size_t k);

/// Each target takes the local interpolant through its k nearest sources.
SparseMap local_interpolation(const std::vector<Vec3>& sources, const std::vector<Vec3>& targets,
                              std::size_t k);

/// Throws Error naming the participant if it lists the corners of its faces, but not as they must be. `vertices`:
/// how many there are on all ranks.
void check_corners(const Interface& surface, const std::string& name, GlobalIndex vertices);

/// From values at the vertices to those at the centres of the faces: the mean over a face's corners, or,
/// where the participant does not list them, a local interpolant.
SparseMap vertices_to_faces(const Interface& surface);

}  // namespace couplet
