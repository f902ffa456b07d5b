// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "common/mesh/load.hpp"

namespace couplet::mesh {

/// What gmsh is to read.
struct GmshInput {
  struct File {
    std::filesystem::path original;
    std::string name, text;  ///< as gmsh gets it
  };
  std::filesystem::path source;  ///< as the user knows it
  /// Copies for gmsh's own folder, the first is the one to read. None: the source itself, which the user trusts.
  std::vector<File> files;
};

/// Runs the gmsh program on `input` with these options; its .msh 4.1 gets the name `result` once it is whole. Several
/// programs of a job may do so at the same time. `verb`: for messages, "mesh" or "read". Throws Error with gmsh's own
/// complaints.
void run_gmsh(const std::vector<std::string>& options, const GmshInput& input,
              const std::filesystem::path& result, const std::string& verb);

/// A mesh of another program (.unv; .med and .cgns where the gmsh at hand was built with them) as .msh, kept beside it as
/// <stem>.<hash>.cache.msh; groups become patches and zones. Throws Error for a format that gmsh does not read.
std::filesystem::path convert_mesh(const std::filesystem::path& file);
/// Whether the gmsh at hand was built with a library, "Med" or "Cgns". False where there is none.
bool gmsh_has(const std::string& library);

/// A mesh that is finished: .msh, .inp, or of another program. Throws Error.
RawMesh read_finished_mesh(const std::filesystem::path& file);

/// That, or the mesh that gmsh makes of a .geo with these parameters. Throws Error if it has not `dim` dimensions. On this rank
/// alone.
RawMesh read_mesh(const std::filesystem::path& file, int dim, const MeshParameters& parameters);

}  // namespace couplet::mesh
