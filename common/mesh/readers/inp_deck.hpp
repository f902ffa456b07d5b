// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <unordered_map>
#include <utility>
#include <vector>

#include "common/csv/csv_reader.hpp"
#include "common/mesh/topology.hpp"

namespace couplet::mesh {

std::string upper(std::string_view text);

/// "*ELEMENT, TYPE=C3D8, ELSET=beam": word and parameters, both in capitals without blanks at their ends; values as they stand.
struct InpKeyword {
  std::string word;
  std::vector<std::pair<std::string, std::string>>
      parameters;  ///< a parameter without "=" has an empty value
  /// Null: not given.
  const std::string* find(std::string_view name) const;
};

/// The lines of an input deck of CalculiX or Abaqus, those of included files in their place. Comments ("**") and empty lines are
/// passed over.
class InpLines final {
 public:
  explicit InpLines(const std::filesystem::path& file);

  /// The next line that counts, which stays until the next call. False at the end. Throws Error.
  bool next();
  bool is_keyword() const { return line_.starts_with('*'); }
  std::string_view text() const { return line_; }
  /// The present line, with those that go on from it: its last character is a comma. Throws Error.
  InpKeyword keyword();
  /// The numbers of the present line and, while there are fewer than `n`, of those that follow it. Throws Error for what is no
  /// whole number above 0.
  void identifiers(std::size_t n, std::vector<std::int64_t>& numbers);
  /// Goes into this file, below the folder of the first. Throws Error.
  void include(const std::string& name);
  [[noreturn]] void fail(const std::string& what) const;
  /// Of the deck.
  const std::string& name() const { return name_; }
  /// "folder/file.inp:12"
  std::string place() const { return files_.empty() ? name_ : files_.back()->place(); }
  /// For place_of() later on.
  std::uint64_t mark() const;
  std::string place_of(std::uint64_t mark) const;

 private:
  void open(const std::filesystem::path& file);

  std::filesystem::path folder_;
  std::string name_;
  std::vector<std::unique_ptr<csv::LineReader>> files_;  // the included one last
  std::vector<std::string> opened_;                      // all names
  std::vector<std::size_t> number_;                      // into opened_, as files_
  std::string_view line_;
  std::vector<std::string_view> cells_;
};

/// A whole number above 0, as nodes and elements have them; 0: none.
std::int64_t identifier_of(std::string_view text);

// Corners come first in CalculiX and Abaqus, in the order of VTK and gmsh, and their faces S1, S2, ... are those of CellShape.

/// Meaning of a name such as "C3D10".
struct InpType {
  enum class Use {
    cell,     ///< of a body
    edge,     ///< a bar of two or three nodes: boundary of a 2-D mesh, else passed over
    nothing,  ///< a spring, a mass: passed over with all its nodes
    unknown
  };
  Use use = Use::unknown;
  CellType cell = CellType::triangle;  ///< of cells
  int n_nodes = 0;                     ///< in the file; more than the corners: of second order
  bool is_cell() const { return use == Use::cell; }
  const CellShape& shape() const { return shape_of(cell); }
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

}  // namespace couplet::mesh
