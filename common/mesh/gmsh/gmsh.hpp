// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "common/mesh/distributed/mesh_block.hpp"

namespace couplet::mesh {

/// Runs the gmsh program on the file `source` with these options; its .msh 4.1 gets the name `result` once it is whole. Several
/// programs of a job may do so at the same time. `verb`: for messages, "mesh" or "read". In the sandbox gmsh reads only what is in the
/// folder of the source; a trusted source has the user's rights. Throws Error with gmsh's own complaints.
void run_gmsh(const std::vector<std::string>& options, const std::filesystem::path& source, bool trusted,
              const std::filesystem::path& result, const std::string& verb);

/// Tells whether a cached mesh is as it was sealed under its name. One that is not (damaged, or of somebody else) is named in the
/// log, and is to be made anew.
bool is_sound_cache(const std::filesystem::path& file);

/// A mesh of another program (.unv; .med and .cgns where the gmsh at hand was built with them) as .msh, kept beside it as
/// <stem>.<hash>.cache.msh; groups become patches and zones. Throws Error for a format that gmsh does not read.
std::filesystem::path convert_mesh(const std::filesystem::path& file);
/// Whether the gmsh at hand was built with a library, "Med" or "Cgns". False where there is none.
bool gmsh_has(const std::string& library);

/// This rank's block of a mesh in a .msh, .inp or .geo (meshed with these parameters) file, or of another program. Throws Error if
/// it has not `dim` dimensions. Collective.
MeshBlock read_mesh(MPI_Comm comm, const std::filesystem::path& file, int dim,
                    const MeshParameters& parameters = {});

/// Of a .msh or .geo (meshed, with its cache), its lengths times `scale`: in three dimensions if it names a physical
/// volume. Throws Error.
MeshFacts facts_of_file(const std::filesystem::path& file, const MeshParameters& parameters, double scale);

/// Formats that the Python module meshio reads for us: .med, .exo, .e, .ex2.
bool is_read_by_meshio(const std::string& extension);

/// Reads such a mesh: python3 runs meshio in a sandbox, as gmsh runs, and hands it over as an input deck (read_inp): groups of cells are
/// zones, groups of faces and sets of nodes patches. Throws Error where python3 or the module is not there, with what to
/// install, and with what meshio has said.
RawMesh read_by_meshio(const std::filesystem::path& file);

}  // namespace couplet::mesh
