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
  /// A last line of which gmsh would leave out all but one statement: "line 3 of 'plate.geo'"; empty: there is none.
  std::string lost;
  /// An Include or Merge whose name is computed, so that changes of its file are not seen: "line 3 of 'plate.geo'"; empty: there is none.
  std::string computed;
  /// Names of the physical groups by dimension (0 to 3); nothing where one of them is computed.
  std::vector<std::optional<std::vector<std::string>>> groups;
};

/// Throws Error if a file cannot be read, or includes itself.
GeoScript read_geo(const std::filesystem::path& file);

}  // namespace couplet::mesh
