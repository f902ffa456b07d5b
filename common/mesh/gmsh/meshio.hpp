// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

#include "common/mesh/load.hpp"

namespace couplet::mesh {

/// Formats that the Python module meshio reads for us: .med, .exo, .e, .ex2.
bool is_read_by_meshio(const std::string& extension);

/// Reads such a mesh: python3 runs meshio in a sandbox, as gmsh runs, and hands it over as an input deck (read_inp): groups of cells are
/// zones, groups of faces and sets of nodes patches. Throws Error where python3 or the module is not there, with what to
/// install, and with what meshio has said.
RawMesh read_by_meshio(const std::filesystem::path& file);

}  // namespace couplet::mesh
