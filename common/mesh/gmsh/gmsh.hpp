// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "common/mesh/load.hpp"

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

/// A mesh that is finished: .msh, .inp, or of another program. Throws Error.
RawMesh read_finished_mesh(const std::filesystem::path& file);

/// That, or the mesh that gmsh makes of a .geo with these parameters. Throws Error if it has not `dim` dimensions. On this rank
/// alone.
RawMesh read_mesh(const std::filesystem::path& file, int dim, const MeshParameters& parameters);

/// What estimates before a run look at.
struct MeshFacts {
  int dim = 3;               ///< 2: cells in the plane only
  Vec3 size = Vec3::Zero();  ///< of the box around the points [m]
  double shortest_edge = 0;  ///< of any cell [m]
  double mean_cell = 0;      ///< (volume of the box over the number of cells)^(1/dim) [m]
  std::size_t cells = 0;
  double smallest_side() const;  ///< of the box, in the directions that the mesh has [m]
  double largest_side() const;
};
MeshFacts facts_of(const RawMesh& raw);

/// Of a .msh or .geo (meshed, with its cache), its lengths times `scale`: in three dimensions if it names a physical
/// volume. Throws Error.
MeshFacts facts_of_file(const std::filesystem::path& file, const MeshParameters& parameters, double scale);

}  // namespace couplet::mesh
