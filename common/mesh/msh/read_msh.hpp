// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/mesh/distributed/mesh_block.hpp"

namespace couplet::mesh {

/// This rank's block of the mesh in a .msh, which the first `holders` ranks read; the order is that of read_msh(). Throws Error
/// with file and line. Collective.
MeshBlock read_msh_block(MPI_Comm comm, const std::filesystem::path& file, int holders);

/// The elementary entity (gmsh's tag of a curve or surface of the drawing) of each boundary element that read_msh() gives
/// for this file, in the order of RawMesh::boundary_points; 0 where the file names none. Throws as read_msh().
std::vector<int> read_boundary_entities(const std::filesystem::path& file);

}  // namespace couplet::mesh
