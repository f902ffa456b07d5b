// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <mpi.h>

#include <filesystem>

#include "common/mesh/distributed/mesh_block.hpp"
#include "common/mesh/gmsh/gmsh.hpp"
#include "common/mesh/load.hpp"

namespace couplet::io {

/// Returns true if the name ends in .h5.
bool is_cut_mesh(const std::filesystem::path& file);

/// Writes the blocks of a mesh into one HDF5 file (docs/formats.md), which gets its name when it is complete.
/// Points without a cell are not allowed. Collective.
void write_cut_mesh(MPI_Comm comm, const mesh::MeshBlock& block, const std::filesystem::path& file);

/// Reads this rank's block, whatever number of ranks wrote the file. Throws Error on all ranks if the file is
/// damaged or of another version. Collective.
mesh::MeshBlock read_cut_mesh(MPI_Comm comm, const std::filesystem::path& file);

/// Reads the facts stored in the file, on this rank only.
mesh::MeshFacts read_cut_mesh_facts(const std::filesystem::path& file);

/// Extends mesh::load_mesh() to cut meshes (.h5), which no rank ever holds as a whole. Collective.
mesh::LoadedMesh load_mesh(MPI_Comm comm, const std::filesystem::path& file, int dim,
                           const mesh::MeshParameters& parameters = {},
                           const std::vector<std::array<std::string, 2>>& periodic = {},
                           const std::vector<std::vector<std::string>>& materials = {},
                           bool find_wide_points = false, double scale = 1, bool tie = false);

/// Extends mesh::facts_of_file() to cut meshes.
mesh::MeshFacts facts_of_file(const std::filesystem::path& file, const mesh::MeshParameters& parameters,
                              double scale);

}  // namespace couplet::io
