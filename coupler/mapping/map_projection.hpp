// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "common/coupling/participant.hpp"
#include "coupler/exchange/transfer.hpp"
#include "coupler/mapping/sparse_map.hpp"

namespace couplet::coupler {

/// Each target takes the value at its nearest point of the surface: linear along edges (2-D) and over the
/// triangles of faces (3-D; a face of more corners is cut into triangles about its centre). Beside the
/// surface's end the value of the end counts.
SparseMap nearest_projection(const coupling::Interface& surface, const std::vector<Vec3>& targets);

/// Throws Error saying what to do where the corners of the faces are not `known`.
void require_corners(bool known);

/// The faces that nearest_projection looks at: the nearest face touches one of so many nearest vertices, or is large and
/// has its centre among so many nearest ones.
inline constexpr std::size_t projection_vertices = 3, projection_faces = 4;
/// Where no face covers a place, the nearest of so many faces nearest to it by their centres counts.
inline constexpr std::size_t nearest_faces = 9;

/// Distance [m] of a place from a face, corners known.
double distance_to_face(const coupling::Interface& surface, Index face, const Vec3& place);

/// Rows of a map by the targets' positions, columns by the sources'.
void add_entries(const SparseMap& map, const std::vector<GlobalIndex>& targets,
                 const std::vector<GlobalIndex>& sources, std::vector<Transfer::Entry>& entries);

/// Each target takes the local interpolant through its k nearest sources.
SparseMap local_interpolation(const std::vector<Vec3>& sources, const std::vector<Vec3>& targets,
                              std::size_t k);

/// Throws Error naming the participant if it lists the corners of its faces, but not as they must be. `vertices`:
/// how many there are on all ranks.
void check_corners(const coupling::Interface& surface, const std::string& name, GlobalIndex vertices);

}  // namespace couplet::coupler
