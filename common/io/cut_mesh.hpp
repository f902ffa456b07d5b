// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <mpi.h>

#include <filesystem>

#include "common/mesh/distributed/mesh_block.hpp"
#include "common/mesh/gmsh/gmsh.hpp"
#include "common/mesh/load.hpp"

namespace couplet::io {

/// Tells by the name, which ends in .h5.
bool is_cut_mesh(const std::filesystem::path& file);

/// Writes the blocks of a mesh into one HDF5 file, under another name until it is complete; see docs/formats.md. Points
/// that no cell has must not be among them. Collective.
void write_cut_mesh(MPI_Comm comm, const mesh::MeshBlock& block, const std::filesystem::path& file);

/// Reads this rank's block, whatever number of ranks wrote the file. Throws Error, on all ranks, for a file that is
/// damaged or of another version. Collective.
mesh::MeshBlock read_cut_mesh(MPI_Comm comm, const std::filesystem::path& file);

/// Facts that are written in the file. On this rank alone.
mesh::MeshFacts read_cut_mesh_facts(const std::filesystem::path& file);

/// As mesh::load_mesh(), of a cut mesh (.h5), too, of which no rank ever has the whole. Collective.
mesh::LoadedMesh load_mesh(MPI_Comm comm, const std::filesystem::path& file, int dim,
                           const mesh::MeshParameters& parameters = {},
                           const std::vector<std::array<std::string, 2>>& periodic = {},
                           const std::vector<std::vector<std::string>>& materials = {},
                           bool find_wide_points = false, double scale = 1);

/// As mesh::facts_of_file(), of a cut mesh, too.
mesh::MeshFacts facts_of_file(const std::filesystem::path& file, const mesh::MeshParameters& parameters,
                              double scale);

}  // namespace couplet::io
