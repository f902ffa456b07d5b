// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <filesystem>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "common/mesh/inp/inp_lines.hpp"
#include "common/mesh/mesh.hpp"

namespace couplet::mesh {

/// An element of CalculiX or Abaqus as a cell. Corners come first in both, in the order of VTK and gmsh.
struct InpShape {
  CellType cell;
  int dim, n_corners, n_faces;
  /// Corners of the faces S1, S2, ...; -1: no such.
  std::array<std::array<std::int8_t, 4>, 6> faces;
};

/// Meaning of a name such as "C3D10".
struct InpType {
  enum class Use {
    cell,     ///< of a body
    edge,     ///< a bar of two or three nodes: boundary of a 2-D mesh, else passed over
    nothing,  ///< a spring, a mass: passed over with all its nodes
    unknown
  };
  Use use = Use::unknown;
  const InpShape* shape = nullptr;  ///< of cells
  int n_nodes = 0;                  ///< in the file; more than the corners: of second order
};

/// Numbers of nodes or elements: first, first + step, ..., last.
struct InpRange {
  std::int64_t first = 0, last = 0, step = 1;
  auto operator<=>(const InpRange&) const = default;
};
struct InpSet {
  std::string name;  ///< as it was written first
  std::vector<InpRange> members;
  bool is_given = false;  ///< by *NSET or *ELSET, not beside nodes or elements alone
};
/// Sets by their names in capitals, in the order of the file.
struct InpSets {
  std::vector<InpSet> all;
  std::map<std::string, std::size_t> number;  ///< into `all`
  InpSet& at(const std::string& name);        ///< made where it is missing
  const InpSet* find(const std::string& name) const;
};

/// Faces of elements, "beam, S3", or nodes.
struct InpSurface {
  struct Part {
    std::vector<InpRange> elements;
    int face = 0;  ///< from 0
    std::uint64_t mark = 0;
  };
  std::string name;
  std::vector<Part> parts;
  std::vector<InpRange> nodes;  ///< of a surface of nodes
};

/// Elements of one kind: their nodes lie one after the other.
struct InpElements {
  struct Element {
    std::int64_t id = 0;
    std::uint64_t mark = 0;  ///< its line
    InpType type;
    std::size_t first_node = 0;
    std::size_t group = 0;  ///< into `groups`: the set of its *ELEMENT
  };
  std::vector<Element> all;
  std::vector<std::int64_t> nodes;  ///< corners alone
  std::vector<std::string> groups;
};

/// What a deck says of a mesh.
struct InpDeck {
  std::vector<Vec3> points;
  std::unordered_map<std::int64_t, Index> point_of_node;
  InpElements elements;
  InpSets node_sets, element_sets;
  std::vector<InpSurface> surfaces;
  std::vector<std::pair<std::string, std::vector<InpRange>>>
      sections;                            ///< *SOLID SECTION: name of its set, its elements
  std::map<std::string, int> passed_over;  ///< keywords and types that say nothing of the mesh
  std::size_t second_order = 0;            ///< elements taken by their corners
};

/// Reads the deck; `lines` stays for the places of what is found wrong later. Throws Error with file and line.
InpDeck read_inp_deck(InpLines& lines);

/// Calls use(number in `index`) for the members that are there, each as often as it is named. `left`: how many more numbers
/// may be looked at, which a crafted deck uses up. False: they are.
template <class Use>
bool for_each_member(const std::vector<InpRange>& ranges,
                     const std::unordered_map<std::int64_t, Index>& index, std::int64_t& left,
                     const Use& use) {
  for (const InpRange& r : ranges) {
    left -= std::min<std::int64_t>((r.last - r.first) / r.step, std::ssize(index)) + 1;
    if (left < 0) return false;
    const auto n = std::size_t((r.last - r.first) / r.step) + 1;
    if (n <= index.size()) {
      for (std::int64_t id = r.first; id <= r.last; id += r.step)
        if (const auto found = index.find(id); found != index.end()) use(found->second);
    } else {
      for (const auto& [id, value] : index)
        if (id >= r.first && id <= r.last && (id - r.first) % r.step == 0) use(value);
    }
  }
  return true;
}

}  // namespace couplet::mesh
