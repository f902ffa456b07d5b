// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace couplet::mesh {

/// A .geo with the files it includes or merges, as far as it must be understood before gmsh gets it.
struct GeoScript {
  /// All of it, one file after the other, so that a change in any of them is seen.
  std::string text;
  /// The names in all DefineConstant [...]: `n = 8` or `n = {8, Name "..."}`.
  std::vector<std::string> constants;
  /// Names that a number of cells is made of, by Layers or Transfinite Curve. `whole`: as they are or with something
  /// added, so that only a whole number is meant.
  std::map<std::string, bool> counts;
  /// What in it is not among the statements that gmsh gets: "'SystemCall' in line 3 of plate.geo"; empty if all is.
  std::string danger;
  /// One sentence about `danger` for a message: what is allowed, what to do.
  std::string refusal() const;
  /// What gmsh gets: the pieces of each file as they were looked at, without comments, under names of our own, the first is
  /// that of the .geo itself; a merged mesh or CAD file as it is.
  struct File {
    std::filesystem::path original;
    std::string name, text;
    bool exists = true;  ///< false: gmsh will say so if it gets there
  };
  std::vector<File> files;
  /// A last line of which gmsh would leave out all but one statement: "line 3 of 'plate.geo'"; empty: there is none.
  std::string lost;
  /// Names of the physical groups by dimension (0 to 3); nothing where one of them is computed.
  std::vector<std::optional<std::vector<std::string>>> groups;
};

/// Throws Error if a file cannot be read.
GeoScript read_geo(const std::filesystem::path& file);

}  // namespace couplet::mesh
