// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "common/mesh/distributed/mesh_block.hpp"

namespace couplet::mesh {

/// Contents of a .geo and the files it includes or merges, as far as they matter before gmsh reads it.
struct GeoScript {
  /// Text of all files, so that a change in any of them is detected.
  std::string text;
  /// Names in all DefineConstant [...]: `n = 8` or `n = {8, Name "..."}`.
  std::vector<std::string> constants;
  /// Names that determine a number of cells, by Layers or Transfinite Curve. True if the name is used as it
  /// is or in a sum, so that its value must be a whole number.
  std::map<std::string, bool> counts;
  /// Last line of which gmsh would read only one statement: "line 3 of 'plate.geo'". Empty if there is none.
  std::string lost;
  /// Untracked Include or Merge with a computed name: "line 3 of 'plate.geo'". Empty if there is none.
  std::string computed;
  /// Names of the physical groups by dimension (0 to 3). Not available if one of them is computed.
  std::vector<std::optional<std::vector<std::string>>> groups;
};

/// Reads a script. Throws Error if a file cannot be read or includes itself.
GeoScript read_geo(const std::filesystem::path& file);

/// Runs gmsh on `source` with these options and renames its complete .msh 4.1 to `result`, a cached mesh.
/// Several programs may do so at the same time. Meshes used long ago are removed if all exceed 4 GB. `verb` is for messages: "mesh" or "read". In the sandbox gmsh reads only the
/// folder of the source; a trusted source has the user's rights. Throws Error with gmsh's messages.
void run_gmsh(const std::vector<std::string>& options, const std::filesystem::path& source, bool trusted,
              const std::filesystem::path& result, const std::string& verb);

/// Path of the mesh made of `source`, <stem>.<hash>.cache.msh in $XDG_CACHE_HOME/couplet/meshes, or below
/// ~/.cache. The hash covers the path of the source and `key`, all that the mesh depends on.
std::filesystem::path cache_of(const std::filesystem::path& source, const std::string& key);

/// Returns true if a cached mesh matches its seal, and marks it as used. A damaged or foreign one is logged
/// and must be regenerated.
bool is_sound_cache(const std::filesystem::path& file);

/// Returns the .msh to read: the file itself, or what gmsh makes of a .msh of another version or of a .cgns,
/// if it supports that, as a cached mesh. Throws Error for a format that gmsh does not read.
std::filesystem::path convert_mesh(const std::filesystem::path& file);

/// Throws Error with advice if a mesh does not exist, is in a format that is not read, or cannot have these
/// parameters.
void check_mesh_file(const std::filesystem::path& file, const MeshParameters& parameters = {});

/// Block of this rank for a mesh in a .msh, .inp, .geo (meshed with these parameters) or foreign file. Throws
/// Error if it does not have `dim` dimensions. Collective.
MeshBlock read_mesh(MPI_Comm comm, const std::filesystem::path& file, int dim,
                    const MeshParameters& parameters = {});

/// Facts of a .msh or .geo (meshed, with its cache), with lengths multiplied by `scale`. It is
/// three-dimensional if it names a physical volume. Throws Error.
MeshFacts facts_of_file(const std::filesystem::path& file, const MeshParameters& parameters, double scale);

/// Returns true for the formats of read_foreign(): input decks of CalculiX and Abaqus (.inp), universal files (.unv), MED, Exodus (.exo, .e, ...), SU2 and
/// Nastran (.bdf, .nas).
bool is_foreign(std::string extension);

/// Formats to export a mesh in, for messages.
inline constexpr std::string_view formats_with_names =
    ".su2 (markers), .bdf (sets and properties), .unv, .med or .cgns (groups), .exo (sets of sides), .inp "
    "(surfaces and sets) or .msh of gmsh (physical groups)";

/// Reads a mesh of another program by a Python script in a sandbox, which passes it on as a .msh. Groups of
/// cells and sections of a deck become zones; groups of faces, surfaces, sets of sides and sets of nodes
/// patches, and the remaining boundary the patch "rest". Elements of second order are reduced to their
/// corners. What the script leaves out is logged. Throws Error with what is wrong, or what to install.
RawMesh read_foreign(const std::filesystem::path& file);

}  // namespace couplet::mesh
