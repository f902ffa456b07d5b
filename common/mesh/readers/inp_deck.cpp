// SPDX-License-Identifier: Apache-2.0
#include "common/mesh/readers/inp_deck.hpp"

#include <fmt/format.h>
#include <algorithm>
#include <limits>

#include "common/base/error.hpp"
#include "common/base/text.hpp"
#include "common/csv/csv_reader.hpp"
#include "common/log/log.hpp"

namespace couplet::mesh {
namespace {

struct Row {
  std::string_view family;
  int n_nodes;
  CellType cell;
};
constexpr Row rows[] = {
    {"C3D", 4, CellType::tetrahedron},   {"C3D", 10, CellType::tetrahedron}, {"C3D", 8, CellType::hexahedron},
    {"C3D", 20, CellType::hexahedron},   {"C3D", 6, CellType::prism},        {"C3D", 15, CellType::prism},
    {"C3D", 5, CellType::pyramid},       {"CPS", 3, CellType::triangle},     {"CPS", 6, CellType::triangle},
    {"CPS", 4, CellType::quadrilateral}, {"CPS", 8, CellType::quadrilateral}};

// Bars and beams with their number of nodes, or 0 for elements that are not part of a mesh.
constexpr std::pair<std::string_view, int> others[] = {
    {"T2D2", 2},    {"T2D3", 3},    {"T3D2", 2},     {"T3D3", 3},   {"B21", 2},    {"B22", 3},
    {"B31", 2},     {"B32", 3},     {"B31R", 2},     {"B32R", 3},   {"MASS", 0},   {"SPRINGA", 0},
    {"SPRING1", 0}, {"SPRING2", 0}, {"DASHPOTA", 0}, {"GAPUNI", 0}, {"ROTARYI", 0}};

/// Type of an element whose `name` is in capitals.
InpType inp_type(std::string_view name) {
  for (const auto& [other, n] : others)
    if (name == other) return {n > 0 ? InpType::Use::edge : InpType::Use::nothing, {}, n};
  if (name.size() < 4) return {};
  const std::string_view family = name.starts_with("CPE") ? "CPS" : name.substr(0, 3);
  std::string_view rest = name.substr(3);
  int n = 0;
  for (; !rest.empty() && rest[0] >= '0' && rest[0] <= '9' && n < 100; rest.remove_prefix(1))
    n = 10 * n + (rest[0] - '0');
  // The remaining letters select the integration: reduced, hybrid, incompatible modes, modified.
  if (rest.find_first_not_of("RHIMS") != std::string_view::npos) return {};
  for (const Row& row : rows)
    if (row.family == family && row.n_nodes == n) return {InpType::Use::cell, row.cell, n};
  return {};
}

/// Reason why an element of unknown type is not read.
std::string why_not_read(std::string_view name) {
  const auto begins = [&](std::initializer_list<const char*> all) {
    return std::ranges::any_of(all, [&](const char* n) { return name.starts_with(n); });
  };
  const char* reason = begins({"CAX", "DCAX"}) ? "axisymmetric elements are not supported"
                       : begins({"S3", "S4", "S6", "S8", "STRI", "SC", "M3D"})
                           ? "shells and membranes are not supported; mesh the wall as a solid"
                       : begins({"DC", "AC", "F", "U"}) ? "it is not a solid element"
                                                        : "it is unknown";
  return fmt::format(
      "elements of type '{}' are not supported ({}). Supported: C3D4, C3D5, C3D6, C3D8, C3D10, C3D15, "
      "C3D20, CPS3, CPS4, CPS6, CPS8 and their CPE equivalents; second-order ones by their corners.",
      name.substr(0, 40), reason);
}

/// Limit on members of all sets, including nested ones, because sets of sets could grow without bound.
constexpr std::size_t most_members = 20000000;
constexpr int most_nested = 1000;  // sets within sets

/// Rejected keywords, which create or move nodes and elements or divide the deck.
constexpr std::pair<std::string_view, std::string_view> refused[] = {
    {"NGEN", "it generates nodes"},      {"NFILL", "it generates nodes"},
    {"NCOPY", "it generates nodes"},     {"NMAP", "it transforms nodes"},
    {"SYSTEM", "it transforms nodes"},   {"ELGEN", "it generates elements"},
    {"ELCOPY", "it generates elements"}, {"SUBMODEL", "it is not a mesh"},
    {"IMPORT", "it reads another file"}, {"MANIFEST", "it reads other files"}};

/// Keywords that connect nodes without a common cell.
constexpr std::string_view connecting[] = {"TIE",
                                           "EQUATION",
                                           "MPC",
                                           "RIGID BODY",
                                           "COUPLING",
                                           "CONTACT PAIR",
                                           "CONTACT",
                                           "SHELL TO SOLID COUPLING",
                                           "EMBEDDED ELEMENT",
                                           "MODEL CHANGE"};

class DeckReader {
 public:
  explicit DeckReader(InpLines& lines) : lines_(lines) {}

  InpDeck read() {
    bool more = lines_.next();
    if (more && !lines_.is_keyword()) lines_.fail("an input deck must begin with a keyword ('*NODE', ...).");
    while (more) more = block();
    for (auto* sets : {&deck_.node_sets, &deck_.element_sets})
      for (InpSet& set : sets->all) resolve(set, *sets, 0);
    for (InpSurface& surface : deck_.surfaces) {
      resolve(surface.nodes, deck_.node_sets, 0);
      for (auto& part : surface.parts) resolve(part.elements, deck_.element_sets, 0);
    }
    for (InpSet& section : deck_.sections) {
      resolve(section, deck_.element_sets, 0);
      section.name = deck_.element_sets.find(section.name)->name;
    }
    return std::move(deck_);
  }

 private:
  /// Reads one keyword with its lines. Returns false at the end.
  bool block() {
    const InpKeyword k = lines_.keyword();
    for (const auto& [word, reason] : refused)
      if (k.word == word)
        lines_.fail(
            fmt::format("*{} is not supported: {}. Export the mesh with all nodes and elements "
                        "written out.",
                        word, reason));
    if (k.word == "NODE") return nodes(k);
    if (k.word == "ELEMENT") return elements(k);
    if (k.word == "NSET") return set(k, "NSET", deck_.node_sets);
    if (k.word == "ELSET") return set(k, "ELSET", deck_.element_sets);
    if (k.word == "SURFACE") return surface(k);
    if (k.word == "SOLID SECTION") return section(k);
    if (k.word == "PART" && ++parts_ > 1)
      lines_.fail(
          "decks with several parts are not supported. Export it flat (Abaqus: 'do not use parts and "
          "assemblies').");
    if (k.word == "INSTANCE") return instance();
    (std::ranges::find(connecting, k.word) == std::end(connecting) ? deck_.passed_over : deck_.connections)
        .insert("*" + k.word.substr(0, 40));
    return skip();
  }

  bool skip() {
    while (lines_.next())
      if (lines_.is_keyword()) return true;
    return false;
  }

  bool instance() {
    if (++instances_ > 1)
      lines_.fail(
          "decks with several instances are not supported. Export it flat (Abaqus: 'do not use parts and "
          "assemblies').");
    const bool more = lines_.next();
    if (more && !lines_.is_keyword())
      lines_.fail("transformed instances are not supported. Export the deck flat.");
    return more;
  }

  /// Names parameters other than these, and continues with the data of INPUT=...
  void open(const InpKeyword& k, std::initializer_list<std::string_view> read) {
    for (const auto& [name, value] : k.parameters)
      if (name != "INPUT" && std::ranges::find(read, name) == read.end())
        log::warn("{}: the parameter {} of *{} is not read.", lines_.place(), name.substr(0, 40), k.word);
    if (const std::string* input = k.find("INPUT")) lines_.include(*input);
  }

  const std::string& required(const InpKeyword& k, const char* name) {
    const std::string* value = k.find(name);
    if (!value || value->empty()) lines_.fail(fmt::format("*{} needs {}=...", k.word, name));
    return *value;
  }

  bool nodes(const InpKeyword& k) {
    if (const std::string* system = k.find("SYSTEM"); system && upper(*system) != "R")
      lines_.fail("*NODE is supported in rectangular coordinates only.");
    open(k, {"NSET", "SYSTEM"});
    InpSet* set = k.find("NSET") ? &deck_.node_sets.at(*k.find("NSET")) : nullptr;
    while (lines_.next() && !lines_.is_keyword()) {
      csv::split_cells(lines_.text(), ',', cells_);
      while (!cells_.empty() && cells_.back().empty()) cells_.pop_back();
      const std::int64_t id = cells_.empty() ? 0 : identifier_of(cells_[0]);
      if (id == 0 || cells_.size() > 7)
        lines_.fail("a node needs a whole number above 0 and up to three coordinates: '12, 0.5, 1, 0'.");
      Vec3 x = Vec3::Zero();
      for (std::size_t a = 1; a < std::min<std::size_t>(cells_.size(), 4); ++a) {
        if (cells_[a].empty()) continue;
        const auto value = csv::number_of(fortran(cells_[a]));
        if (!value) lines_.fail(csv::why_no_number(cells_[a]));
        x[Index(a) - 1] = *value;
      }
      if (deck_.points.size() >= std::size_t(std::numeric_limits<Index>::max()))
        lines_.fail("too many nodes for a mesh.");
      if (!deck_.point_of_node.emplace(id, static_cast<Index>(deck_.points.size())).second)
        lines_.fail(fmt::format("node {} is defined twice.", id));
      deck_.points.push_back(x);
      if (set) add(*set, {id, id, 1});
    }
    return lines_.is_keyword();
  }

  /// Converts "1.5D+03" of old programs.
  std::string_view fortran(std::string_view cell) {
    const std::size_t d = cell.find_first_of("dD");
    if (d == std::string_view::npos) return cell;
    number_ = cell;
    number_[d] = 'e';
    return number_;
  }

  bool elements(const InpKeyword& k) {
    const std::string name = upper(required(k, "TYPE"));
    const InpType type = inp_type(name);
    if (type.use == InpType::Use::unknown) lines_.fail(why_not_read(name));
    open(k, {"TYPE", "ELSET"});
    if (type.use == InpType::Use::nothing) {
      deck_.passed_over.insert(name);
      while (lines_.next() && !lines_.is_keyword()) {
        csv::split_cells(lines_.text(), ',', cells_);
        deck_.other_elements.emplace(identifier_of(cells_[0]), 0);
      }
      return lines_.is_keyword();
    }
    const std::string* own_set = k.find("ELSET");
    if (own_set) deck_.element_sets.at(*own_set);
    deck_.elements.groups.push_back(own_set ? deck_.element_sets.find(*own_set)->name : "");
    const std::size_t n_kept = type.is_cell() ? std::size_t(type.shape().n_points) : 2;
    while (lines_.next() && !lines_.is_keyword()) {
      const std::uint64_t mark = lines_.mark();
      lines_.identifiers(std::size_t(type.n_nodes) + 1, numbers_);
      if (numbers_.size() != std::size_t(type.n_nodes) + 1)
        lines_.fail(fmt::format("a {} needs its number and {} nodes; found {} numbers.", name, type.n_nodes,
                                numbers_.size()));
      const auto corners = std::span(numbers_).subspan(1, n_kept);
      for (std::size_t i = 1; i < corners.size(); ++i)
        if (std::ranges::find(corners.first(i), corners[i]) != corners.first(i).end())
          lines_.fail(fmt::format(
              "element {} has node {} twice. Degenerate cells are not supported; use a C3D6, C3D5 or C3D4.",
              numbers_[0], corners[i]));
      deck_.elements.all.push_back(
          {numbers_[0], mark, type, deck_.elements.nodes.size(), deck_.elements.groups.size() - 1});
      deck_.elements.nodes.insert(deck_.elements.nodes.end(), corners.begin(), corners.end());
      if (type.is_cell() && type.n_nodes > type.shape().n_points) ++deck_.second_order;
      if (own_set) add(deck_.element_sets.at(*own_set), {numbers_[0], numbers_[0], 1});
    }
    return lines_.is_keyword();
  }

  /// Merges consecutive numbers into one range.
  void add(InpSet& set, const InpRange& range) {
    if (!set.members.empty() && range.step == 1 && set.members.back().step == 1 &&
        set.members.back().is_generated == range.is_generated && set.members.back().last + 1 == range.first) {
      set.members.back().last = range.last;
      return;
    }
    if (++members_ > most_members)
      lines_.fail(fmt::format("the sets of this deck have more than {} members.", most_members));
    set.members.push_back(range);
  }

  /// Adds a number, or a set that may be defined later.
  void add_named(InpSet& set, std::string_view cell) {
    if (const std::int64_t id = identifier_of(cell); id > 0) return add(set, {id, id, 1});
    if (++members_ > most_members) lines_.fail("the sets of this deck have too many members.");
    set.sets.push_back({std::string(cell), lines_.mark()});
  }

  /// Adds the members of the sets that `set` contains.
  void resolve(InpSet& set, InpSets& sets, int depth) {
    for (const auto& [name, mark] : set.sets) {
      if (depth > most_nested)
        lines_.fail_at(mark,
                       fmt::format("sets contain each other, or are nested deeper than {}.", most_nested));
      InpSet* other = sets.find(name);
      if (!other)
        lines_.fail_at(mark, fmt::format("'{}' is neither a number nor the name of an {}.",
                                         name.substr(0, 60), &sets == &deck_.node_sets ? "NSET" : "ELSET"));
      if (other == &set) continue;
      resolve(*other, sets, depth + 1);
      for (const InpRange& r : other->members) add(set, r);
    }
    set.sets.clear();
    std::ranges::sort(set.members);
    set.members.erase(std::unique(set.members.begin(), set.members.end()), set.members.end());
  }

  bool set(const InpKeyword& k, const char* kind, InpSets& sets) {
    const std::string name = required(k, kind);
    const bool generates = k.find("GENERATE") != nullptr;
    if (&sets == &deck_.node_sets && k.find("ELSET"))
      lines_.fail("*NSET of the nodes of an ELSET is not supported; list the nodes.");
    open(k, {kind, "GENERATE", "INSTANCE", "INTERNAL", "UNSORTED"});
    sets.at(name).is_given = true;
    while (lines_.next() && !lines_.is_keyword()) {
      InpSet& here = sets.at(name);
      if (generates) {
        lines_.identifiers(2, numbers_);
        const std::int64_t step = numbers_.size() > 2 ? numbers_[2] : 1;
        if (numbers_.size() > 3 || numbers_[1] < numbers_[0])
          lines_.fail("GENERATE needs first, last and step: '1, 100, 3'.");
        add(here, {numbers_[0], numbers_[1] - (numbers_[1] - numbers_[0]) % step, step, true});
        continue;
      }
      csv::split_cells(lines_.text(), ',', cells_);
      for (const std::string_view cell : cells_)
        if (!cell.empty()) add_named(here, cell);
    }
    return lines_.is_keyword();
  }

  bool surface(const InpKeyword& k) {
    InpSurface surface{required(k, "NAME"), {}, {}};
    if (!surface_names_.insert(upper(surface.name)).second)
      lines_.fail(fmt::format("the surface '{}' is defined twice.", surface.name.substr(0, 60)));
    if (k.find("COMBINE") || k.find("CROP"))
      lines_.fail("surfaces composed of other surfaces are not supported; list the faces.");
    const std::string type = k.find("TYPE") ? upper(*k.find("TYPE")) : "ELEMENT";
    if (type != "ELEMENT" && type != "NODE")
      lines_.fail(
          fmt::format("surfaces of TYPE={} are not supported; use ELEMENT or NODE.", type.substr(0, 40)));
    open(k, {"NAME", "TYPE", "INTERNAL"});
    while (lines_.next() && !lines_.is_keyword()) {
      csv::split_cells(lines_.text(), ',', cells_);
      if (type == "NODE") {
        add_named(surface.nodes, cells_[0]);
        continue;
      }
      const std::string face = cells_.size() > 1 ? upper(cells_[1]) : "";
      if (face.size() != 2 || face[0] != 'S' || face[1] < '1' || face[1] > '6')
        lines_.fail(fmt::format("expected a face of an element or of an ELSET, such as 'beam, S3', not '{}'.",
                                lines_.text().substr(0, 60)));
      surface.parts.push_back({{}, face[1] - '1', lines_.mark()});
      add_named(surface.parts.back().elements, cells_[0]);
    }
    deck_.surfaces.push_back(std::move(surface));
    return lines_.is_keyword();
  }

  bool section(const InpKeyword& k) {
    const std::string& name = required(k, "ELSET");
    deck_.sections.push_back({name.substr(name.rfind('.') + 1), {}, {{name, lines_.mark()}}});
    return skip();
  }

  InpLines& lines_;
  InpDeck deck_;
  std::vector<std::string_view> cells_;
  std::vector<std::int64_t> numbers_;
  std::string number_;
  std::set<std::string> surface_names_;
  std::size_t members_ = 0;
  int parts_ = 0, instances_ = 0;
};

/// Key of a set. Abaqus writes the instance before its name: "Part-1-1.top".
std::string key_of(const std::string& name) { return upper(name.substr(name.rfind('.') + 1)); }

}  // namespace

InpSet& InpSets::at(const std::string& name) {
  const auto [found, is_new] = number.try_emplace(key_of(name), all.size());
  if (is_new) all.push_back({name.substr(name.rfind('.') + 1), {}, {}});
  return all[found->second];
}

InpSet* InpSets::find(const std::string& name) {
  const auto found = number.find(key_of(name));
  return found == number.end() ? nullptr : &all[found->second];
}

InpDeck read_inp_deck(InpLines& lines) { return DeckReader(lines).read(); }

}  // namespace couplet::mesh
