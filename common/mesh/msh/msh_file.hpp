// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <cstring>
#include <filesystem>
#include <map>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "common/base/error.hpp"
#include "common/mesh/load.hpp"
#include "common/mesh/msh/msh_groups.hpp"

namespace couplet::mesh {

/// What versions 2.2 and 4.1 have in common: points, elements with gmsh's type numbers, physical groups.
struct MshContent {
  MshNames names;
  std::vector<Vec3> points;
  std::unordered_map<std::size_t, Index> point_of_tag;

  struct Element {
    int type;
    int first_group, n_groups;  ///< range in `groups`
    std::size_t first_node;     ///< index in `nodes`
    int entity = 0;             ///< tag of the curve, surface or volume of the drawing; 0: not named
  };
  std::vector<Element> elements;
  std::vector<int> groups;  ///< tags of physical groups
  std::vector<Index> nodes;
};

/// Dimension and number of nodes of a gmsh element type that is read here; nullptr otherwise.
struct MshElementType {
  int gmsh, dim, n_nodes;
  const char* name;
};
const MshElementType* find_msh_type(int gmsh);

/// A .msh file in memory, read from front to back.
class MshCursor {
 public:
  MshCursor(std::filesystem::path file, std::string text) : file_(std::move(file)), text_(std::move(text)) {}

  bool binary = false;

  /// Throws Error "file:line: ..." (for binary files "file, byte n, in $Section: ...").
  [[noreturn]] void fail(const std::string& what) const;

  bool at_end() const { return at_ >= text_.size(); }
  /// The rest of the current line, trimmed; the cursor goes to the next line.
  std::string line();
  /// Next line that is not empty and starts a section: "Nodes" for "$Nodes"; "" at the end of the file.
  std::string next_section();
  /// To behind "$End<section>".
  void skip_section();
  void end_section();

  /// Numbers: words of text or bytes, as the file is.
  int integer() { return binary ? raw<int>() : static_cast<int>(text_integer()); }
  std::size_t size() { return binary ? raw<std::size_t>() : static_cast<std::size_t>(text_integer()); }
  double real() {
    const double value = binary ? raw<double>() : text_real();
    if (!std::isfinite(value)) fail(fmt::format("Expected a finite number, found '{}'.", value));
    return value;
  }
  /// Numbers that are text in binary files too.
  long text_integer();
  double text_real();
  template <class T>
  T raw() {
    if (text_.size() - at_ < sizeof(T))
      fail("The file ends here in the middle of its data. It is incomplete.");
    T value;
    std::memcpy(&value, text_.data() + at_, sizeof(T));
    at_ += sizeof(T);
    return value;
  }
  /// A count of things that take at least a byte each: refuses what the file cannot hold.
  std::size_t count();
  std::string quoted();
  void end_of_line();

 private:
  std::string_view word();
  std::filesystem::path file_;
  std::string text_;
  std::size_t at_ = 0;
  std::string section_;
};

/// The element's type must be one that is read here; explains higher orders.
const MshElementType& msh_type_or_fail(const MshCursor& cursor, int gmsh);
Index point_or_fail(const MshCursor& cursor, const MshContent& content, std::size_t tag);

void read_msh_2_2(MshCursor& cursor, const std::string& section, MshContent& content);

/// Entities come before the elements that belong to them.
class MshReader41 {
 public:
  void read(MshCursor& cursor, const std::string& section, MshContent& content);

 private:
  void read_entities(MshCursor& cursor);
  void read_nodes(MshCursor& cursor, MshContent& content) const;
  void read_elements(MshCursor& cursor, MshContent& content) const;
  std::map<std::pair<int, int>, std::vector<int>> groups_of_entity_;
};

}  // namespace couplet::mesh
