// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <vector>

namespace couplet::mesh {

/// The elementary entity (gmsh's tag of a curve or surface of the drawing) of each boundary element that read_msh() gives
/// for this file, in the order of RawMesh::boundary_points; 0 where the file names none. Throws as read_msh().
std::vector<int> read_boundary_entities(const std::filesystem::path& file);

}  // namespace couplet::mesh
