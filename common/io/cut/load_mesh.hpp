// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/mesh/gmsh/mesh_facts.hpp"
#include "common/mesh/load.hpp"

namespace couplet::io {

/// As mesh::load_mesh(), of a cut mesh (.h5), too, of which no rank ever has the whole. Collective.
mesh::LoadedMesh load_mesh(MPI_Comm comm, const std::filesystem::path& file, int dim,
                           const mesh::MeshParameters& parameters = {},
                           const std::vector<std::array<std::string, 2>>& periodic = {},
                           const std::vector<std::vector<std::string>>& materials = {},
                           bool find_wide_points = false, double scale = 1);

/// As mesh::facts_of_file(), of a cut mesh, too, which has them written in it.
mesh::MeshFacts facts_of_file(const std::filesystem::path& file, const mesh::MeshParameters& parameters,
                              double scale);

}  // namespace couplet::io
