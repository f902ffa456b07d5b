// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

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

}  // namespace couplet::mesh
