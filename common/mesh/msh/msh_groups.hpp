// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstdlib>
#include <limits>
#include <map>
#include <string>
#include <vector>

#include "common/base/error.hpp"
#include "common/mesh/load.hpp"

namespace couplet::mesh {

/// Name of a physical group by (dimension, tag), in the order of the file.
using MshNames = std::vector<std::pair<std::pair<int, int>, std::string>>;

/// Tag of a group as an entity names it; negative: turned around; the least int has no counterpart and names no group.
inline int msh_group(int tag) { return tag == std::numeric_limits<int>::min() ? tag : std::abs(tag); }

/// Gives out patch (or zone) numbers for the physical groups of one dimension: names in the order of
/// $PhysicalNames, then unnamed groups as "physical_<tag>" in the order in which elements use them. Groups
/// without elements are left out.
class MshGroups {
 public:
  MshGroups(const MshNames& names, int dim) {
    for (const auto& [key, name] : names)
      if (key.first == dim) number(key.second, name);
  }
  int use(int tag) {
    const auto found = number_of_tag_.find(tag);
    const int g =
        found != number_of_tag_.end() ? found->second : number(tag, fmt::format("physical_{}", tag));
    used_[g] = true;
    return g;
  }
  int use_default() {
    if (default_ < 0) default_ = number(0, "default");
    used_[default_] = true;
    return default_;
  }
  /// Drops the unused names; `numbers` are renumbered.
  std::vector<std::string> finish(std::vector<int>& numbers) const {
    std::vector<std::string> kept;
    std::vector<int> renumbered(names_.size(), -1);
    for (std::size_t g = 0; g < names_.size(); ++g) {
      if (!used_[g]) continue;
      renumbered[g] = static_cast<int>(kept.size());
      kept.push_back(names_[g]);
    }
    for (int& n : numbers) n = renumbered[n];
    return kept;
  }

  const std::string& name(int number) const { return names_[number]; }

 private:
  /// Two tags may carry the same name: one patch.
  int number(int tag, const std::string& name) {
    const auto same = std::find(names_.begin(), names_.end(), name);
    const int g = static_cast<int>(same - names_.begin());
    if (same == names_.end()) {
      names_.push_back(name);
      used_.push_back(false);
    }
    return number_of_tag_[tag] = g;
  }
  std::vector<std::string> names_;
  std::vector<bool> used_;
  std::map<int, int> number_of_tag_;
  int default_ = -1;
};

/// Of a type that find_msh_type() knows, with the dimension of the mesh.
inline CellType msh_cell_type(int gmsh) {
  switch (gmsh) {
    case 2:
      return CellType::triangle;
    case 3:
      return CellType::quadrilateral;
    case 4:
      return CellType::tetrahedron;
    case 5:
      return CellType::hexahedron;
    case 6:
      return CellType::prism;
    default:
      return CellType::pyramid;
  }
}

}  // namespace couplet::mesh
