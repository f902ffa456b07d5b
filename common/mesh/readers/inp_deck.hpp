// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <string_view>
#include <unordered_map>
#include <utility>
#include <vector>

#include "common/csv/csv_reader.hpp"
#include "common/mesh/topology.hpp"

namespace couplet::mesh {

std::string upper(std::string_view text);

/// Keyword line such as "*ELEMENT, TYPE=C3D8, ELSET=beam". Words and parameter names are in capitals.
struct InpKeyword {
  std::string word;
  /// A parameter without "=" has an empty value.
  std::vector<std::pair<std::string, std::string>> parameters;
  /// Value of a parameter. nullptr if it is not given.
  const std::string* find(std::string_view name) const;
};

/// Lines of a CalculiX or Abaqus input deck with included files in place, be they of keywords or of data.
/// Comments ("**", or a single star) and empty lines are skipped.
class InpLines final {
 public:
  explicit InpLines(const std::filesystem::path& file);

  /// Reads the next relevant line, valid until the next call. Returns false at the end. Throws Error.
  bool next();
  bool is_keyword() const { return line_.starts_with('*'); }
  std::string_view text() const { return line_; }
  /// Parses the current line and its continuations (a line that ends with a comma continues). Throws Error.
  InpKeyword keyword();
  /// Appends the numbers of the current line and, up to `n`, of the following lines. Throws Error for
  /// anything but a whole number above 0.
  void identifiers(std::size_t n, std::vector<std::int64_t>& numbers);
  /// Opens an included file, which must lie below the folder of the first. Throws Error.
  void include(const std::string& name);
  [[noreturn]] void fail(const std::string& what) const;
  [[noreturn]] void fail_at(std::uint64_t mark, const std::string& what) const;
  /// Name of the deck.
  const std::string& name() const { return name_; }
  /// Location "folder/file.inp:12".
  std::string place() const { return files_.empty() ? name_ : files_.back()->place(); }
  /// Mark of the current line, for place_of().
  std::uint64_t mark() const;
  std::string place_of(std::uint64_t mark) const;

 private:
  void open(const std::filesystem::path& file);

  std::filesystem::path folder_;
  std::string name_;
  std::vector<std::unique_ptr<csv::LineReader>> files_;  // the included one last
  std::vector<std::string> opened_;                      // all names
  std::vector<std::size_t> number_;                      // index into opened_, parallel to files_
  std::string_view line_;
  std::vector<std::string_view> cells_;
};

/// Parses a whole number above 0, as used for nodes and elements. Returns 0 if it is not valid.
std::int64_t identifier_of(std::string_view text);

// CalculiX and Abaqus list corners first, in VTK order. Their faces S1, S2, ... match those of CellShape.

/// Meaning of an element type such as "C3D10".
struct InpType {
  enum class Use {
    cell,     ///< of a body
    edge,     ///< a bar of two or three nodes: boundary of a 2-D mesh, otherwise skipped
    nothing,  ///< a spring or mass, skipped with all its nodes
    unknown
  };
  Use use = Use::unknown;
  CellType cell = CellType::triangle;  ///< of cells
  int n_nodes = 0;                     ///< in the file; more than the corners for second order
  bool is_cell() const { return use == Use::cell; }
  const CellShape& shape() const { return shape_of(cell); }
};

/// Range of node or element numbers: first, first + step, ..., last.
struct InpRange {
  std::int64_t first = 0, last = 0, step = 1;
  bool is_generated = false;  ///< by GENERATE, which may have gaps; listed members must exist
  auto operator<=>(const InpRange&) const = default;
};
struct InpSet {
  struct Reference {
    std::string name;
    std::uint64_t mark = 0;
  };
  std::string name;  ///< as it was written first
  std::vector<InpRange> members;
  std::vector<Reference> sets;  ///< that it contains; empty once the deck is read
  bool is_given = false;        ///< by *NSET or *ELSET, not only beside nodes or elements
};
/// Sets by their names in capitals, in the order of the file.
struct InpSets {
  std::vector<InpSet> all;
  std::map<std::string, std::size_t> number;  ///< into `all`
  InpSet& at(const std::string& name);        ///< created if missing
  InpSet* find(const std::string& name);
};

/// Surface made of element faces ("beam, S3") or of nodes.
struct InpSurface {
  struct Part {
    InpSet elements;
    int face = 0;  ///< from 0
    std::uint64_t mark = 0;
  };
  std::string name;
  std::vector<Part> parts;
  InpSet nodes;  ///< for a surface of nodes
};

/// Elements of a deck with their corners stored contiguously.
struct InpElements {
  struct Element {
    std::int64_t id = 0;
    std::uint64_t mark = 0;  ///< its line
    InpType type;
    std::size_t first_node = 0;
    std::size_t group = 0;  ///< into `groups`: the set of its *ELEMENT
  };
  std::vector<Element> all;
  std::vector<std::int64_t> nodes;  ///< only corners
  std::vector<std::string> groups;
};

/// Mesh data of an input deck.
struct InpDeck {
  std::vector<Vec3> points;
  std::unordered_map<std::int64_t, Index> point_of_node;
  InpElements elements;
  InpSets node_sets, element_sets;
  std::vector<InpSurface> surfaces;
  /// Sections from *SOLID SECTION, named by their sets.
  std::vector<InpSet> sections;
  std::set<std::string> passed_over;  ///< keywords and types that are irrelevant for the mesh
  std::set<std::string> connections;  ///< keywords that connect nodes of the mesh, which are not read
  std::unordered_map<std::int64_t, Index> other_elements;  ///< numbers of elements that are no cells
  std::size_t second_order = 0;                            ///< elements reduced to their corners
};

/// Reads the deck. `lines` is kept to locate faults found later. Throws Error with file and line.
InpDeck read_inp_deck(InpLines& lines);

}  // namespace couplet::mesh
