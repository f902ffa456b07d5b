// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <map>
#include <string>
#include <unordered_map>
#include <vector>

#include "common/base/error.hpp"
#include "common/base/text.hpp"
#include "common/log/log.hpp"
#include "common/mesh/load.hpp"
#include "common/mesh/readers/inp_deck.hpp"
#include "common/mesh/topology.hpp"

namespace couplet::mesh {
namespace {

constexpr std::size_t most_words = 20;  // in a message

/// At most the first words, with the number of the others.
std::string beginning_of(std::vector<std::string> words) {
  const std::size_t n = words.size();
  if (n > most_words) words.resize(most_words), words.push_back(fmt::format("{} more", n - most_words));
  return base::join(words);
}

/// Mesh under construction from a deck.
struct InpBody {
  InpLines& lines;
  InpDeck deck;
  RawMesh raw;
  std::unordered_map<std::int64_t, Index> cell_of_element;
  std::vector<const InpElements::Element*> elements;  ///< per cell
  std::int64_t work = 300000000;                      ///< remaining limit on visited members of ranges

  /// Calls use(number in `index`) for existing members, as often as they are named. Throws Error if a crafted
  /// deck has too many.
  template <class Use>
  void visit(const std::vector<InpRange>& members, const std::unordered_map<std::int64_t, Index>& index,
             const Use& use) {
    for (const InpRange& r : members) {
      work -= std::min<std::int64_t>((r.last - r.first) / r.step, std::ssize(index)) + 1;
      if (work < 0) throw Error("{}: the sets of this deck have too many members.", lines.place());
      if (std::size_t((r.last - r.first) / r.step) < index.size()) {
        for (std::int64_t id = r.first; id <= r.last; id += r.step)
          if (const auto found = index.find(id); found != index.end()) use(found->second);
      } else {
        for (const auto& [id, value] : index)
          if (id >= r.first && id <= r.last && (id - r.first) % r.step == 0) use(value);
      }
    }
  }
};

/// Number of a name, ignoring case. A new name is appended to `names`.
int number_in(std::vector<std::string>& names, std::map<std::string, int>& numbers, const std::string& name) {
  const auto [found, is_new] = numbers.try_emplace(upper(name), static_cast<int>(names.size()));
  if (is_new) names.push_back(name);
  return found->second;
}

using Corners = std::array<Index, 4>;
constexpr Index none = -1;

Corners key_of(std::span<const Index> points) {
  Corners key{none, none, none, none};
  std::ranges::copy(points, key.begin());
  std::ranges::sort(key);
  return key;
}

/// Assigns a patch to every boundary face: by *SURFACE, by lower-dimensional elements with an ELSET, or by
/// the smallest NSET with all its nodes. The remaining faces form the patch "rest".
class InpPatches {
 public:
  explicit InpPatches(InpBody& body)
      : body_(body),
        deck_(body.deck),
        raw_(body.raw),
        outer_(outer_faces(body.raw)),
        patch_of_face_(std::size_t(outer_.size()), none) {
    faces_.reserve(std::size_t(outer_.size()));
    for (Index f = 0; f < outer_.size(); ++f) faces_.emplace_back(key_of(outer_[f]), f);
    std::ranges::sort(faces_);
  }

  /// Returns the number of surface faces between two cells. Throws Error.
  std::size_t name() {
    for (const InpSurface& surface : deck_.surfaces) take_surface(surface);
    take_flat_elements();
    take_node_sets();
    name_rest();
    return inner_;
  }

 private:
  int number_of(const std::string& name) { return number_in(raw_.patches, numbers_, name); }

  /// Index into outer_, or `none` if it lies between two cells or belongs to none.
  Index outer_face(std::span<const Index> points) const {
    const Corners key = key_of(points);
    const auto found = std::ranges::lower_bound(faces_, key, {}, &std::pair<Corners, Index>::first);
    return found != faces_.end() && found->first == key ? found->second : none;
  }

  void assign(Index face, int patch) {
    int& of_face = patch_of_face_[std::size_t(face)];
    if (of_face != none && of_face != patch) {
      Vec3 mean = Vec3::Zero();
      for (const Index p : outer_[face]) mean += raw_.points[std::size_t(p)] / double(outer_[face].size());
      throw Error(
          "{}: the boundary face at {} is in two surfaces, '{}' and '{}'. Every boundary face must be in "
          "exactly one.",
          body_.lines.place(), place(mean, raw_.dim), raw_.patches[std::size_t(of_face)],
          raw_.patches[std::size_t(patch)]);
    }
    of_face = patch;
  }

  void take_surface(const InpSurface& surface) {
    const int patch = number_of(surface.name);
    std::vector<Index> points;
    for (const InpSurface::Part& part : surface.parts)
      body_.visit(part.elements.members, body_.cell_of_element, [&](Index cell) {
        const CellShape& shape = shape_of(raw_.cell_type[std::size_t(cell)]);
        if (part.face >= shape.n_faces)
          throw Error("{}: surface '{}': element {} has faces S1 to S{} only.",
                      body_.lines.place_of(part.mark), surface.name, body_.elements[std::size_t(cell)]->id,
                      shape.n_faces);
        points.clear();
        for (const std::int8_t corner : shape.faces[std::size_t(part.face)])
          if (corner >= 0) points.push_back(raw_.cell_points[cell][std::size_t(corner)]);
        const Index face = outer_face(points);
        if (face == none)
          ++inner_;
        else
          assign(face, patch);
      });
    if (!surface.nodes.members.empty()) take_nodes(surface.nodes.members, patch, true);
  }

  /// Uses lower-dimensional elements, as meshers write them for groups of surfaces: by their smallest *ELSET,
  /// else by that of their *ELEMENT.
  void take_flat_elements() {
    std::unordered_map<std::int64_t, Index> face_of_element;
    std::vector<Index> points;
    for (const auto& e : deck_.elements.all) {
      const int corners = e.type.is_cell() ? e.type.shape().n_points : 2;
      if ((e.type.is_cell() ? e.type.shape().dim : 1) != raw_.dim - 1) continue;
      points.clear();
      for (int i = 0; i < corners; ++i) {
        const auto found = deck_.point_of_node.find(deck_.elements.nodes[e.first_node + std::size_t(i)]);
        if (found != deck_.point_of_node.end()) points.push_back(found->second);
      }
      if (std::ssize(points) < corners) continue;
      inner_ += face_of_element.emplace(e.id, outer_face(points)).first->second == none;
    }
    if (face_of_element.empty()) return;
    std::vector<std::pair<std::size_t, const InpSet*>> by_size;
    for (const InpSet& set : deck_.element_sets.all) {
      std::size_t n = 0, inner = 0;
      body_.visit(set.members, face_of_element, [&](Index face) { ++(face == none ? inner : n); });
      if (n > 0) by_size.emplace_back(set.is_given ? n : n + face_of_element.size(), &set);
      if (n == 0 && inner > 0) lose(set);
    }
    std::ranges::stable_sort(by_size, {}, &std::pair<std::size_t, const InpSet*>::first);
    for (const auto& [n, set] : by_size) {
      bool is_used = false;
      body_.visit(set->members, face_of_element, [&](Index face) {
        if (face == none || patch_of_face_[std::size_t(face)] != none) return;
        assign(face, number_of(set->name));
        is_used = true;
      });
      if (!is_used) lose(*set);
    }
  }

  /// Sets beside elements are named where there are no others, for gmsh writes one for each surface.
  void lose(const InpSet& set) {
    if (set.is_given || std::ranges::none_of(deck_.element_sets.all, &InpSet::is_given))
      lost_.push_back(set.name);
  }

  /// Uses node sets, smaller ones first ("tip" within "top"). Skips a set of all points and one with the name
  /// of a surface, which only defines it.
  void take_node_sets() {
    std::vector<std::pair<std::size_t, const InpSet*>> by_size;
    std::vector<Index> seen(raw_.points.size(), none);
    for (std::size_t s = 0; s < deck_.node_sets.all.size(); ++s) {
      const InpSet& set = deck_.node_sets.all[s];
      std::size_t n = 0;
      body_.visit(set.members, deck_.point_of_node, [&](Index p) {
        n += seen[std::size_t(p)] != static_cast<Index>(s);
        seen[std::size_t(p)] = static_cast<Index>(s);
      });
      if (n >= 2 && n < raw_.points.size() && !numbers_.contains(upper(set.name)))
        by_size.emplace_back(n, &set);
    }
    std::ranges::stable_sort(by_size, {}, &std::pair<std::size_t, const InpSet*>::first);
    for (const auto& [n, set] : by_size) take_nodes(set->members, number_of(set->name), false);
  }

  /// Assigns the faces whose points are all in this set.
  void take_nodes(const std::vector<InpRange>& members, int patch, bool is_surface) {
    if (marked_.empty()) {
      marked_.assign(raw_.points.size(), none);
      faces_of_point_ = transpose(outer_, 0, static_cast<Index>(raw_.points.size()));
    }
    std::vector<Index> points;
    body_.visit(members, deck_.point_of_node, [&](Index p) {
      if (marked_[std::size_t(p)] != patch) points.push_back(p);
      marked_[std::size_t(p)] = patch;
    });
    for (const Index p : points)
      for (const Index f : faces_of_point_[p]) {
        const bool is_whole =
            std::ranges::all_of(outer_[f], [&](Index q) { return marked_[std::size_t(q)] == patch; });
        if (is_whole && (is_surface || patch_of_face_[std::size_t(f)] == none)) assign(f, patch);
      }
  }

  /// Names the remaining faces and removes patches without faces.
  void name_rest() {
    for (Index f = 0; f < outer_.size(); ++f)
      if (patch_of_face_[std::size_t(f)] == none) patch_of_face_[std::size_t(f)] = rest_of(raw_.patches);
    std::vector<int> renumbered(raw_.patches.size(), none);
    for (const int patch : patch_of_face_) renumbered[std::size_t(patch)] = 0;
    std::vector<std::string> kept;
    for (std::size_t p = 0; p < renumbered.size(); ++p) {
      if (renumbered[p] == none) lost_.push_back(raw_.patches[p]);
      if (renumbered[p] == none) continue;
      renumbered[p] = static_cast<int>(kept.size());
      kept.push_back(raw_.patches[p]);
    }
    raw_.patches = std::move(kept);
    if (!lost_.empty())
      log::info("'{}': these name no patch, since no boundary face is left for them: {}.", body_.lines.name(),
                beginning_of(lost_));
    for (int& patch : patch_of_face_) patch = renumbered[std::size_t(patch)];
    raw_.boundary_points = std::move(outer_);
    raw_.boundary_patch = std::move(patch_of_face_);
  }

  InpBody& body_;
  InpDeck& deck_;
  RawMesh& raw_;
  std::map<std::string, int> numbers_;  // of patches, by their names in capitals
  Csr outer_;
  std::vector<std::pair<Corners, Index>> faces_;  // outer_ by its points, ascending
  std::vector<int> patch_of_face_;
  Csr faces_of_point_;
  std::vector<int> marked_;  // per point: the last patch that marked it
  std::size_t inner_ = 0;
  std::vector<std::string> lost_;  // names without a face of their own
};

/// Converts a deck to cells, zones and patches.
class InpMesh {
 public:
  explicit InpMesh(InpLines& lines) : lines_(lines), body_{lines, read_inp_deck(lines), {}, {}, {}} {}

  RawMesh make() {
    raw_.dim = 2;
    for (const auto& e : deck_.elements.all)
      if (e.type.is_cell() && e.type.shape().dim == 3) raw_.dim = 3;
    raw_.points = std::move(deck_.points);
    make_cells();
    if (raw_.cell_type.empty())
      throw Error("{}: the deck has no solid elements (C3D4, C3D8, CPS4, ...).", lines_.name());
    name_missing();
    drop_unused();
    find_zones();
    report(InpPatches(body_).name());
    return std::move(raw_);
  }

 private:
  Index point_of(const InpElements::Element& e, std::int64_t node) const {
    const auto found = deck_.point_of_node.find(node);
    if (found == deck_.point_of_node.end())
      throw Error("{}: element {} has node {}, which the deck does not define.", lines_.place_of(e.mark),
                  e.id, node);
    return found->second;
  }

  bool is_cell(const InpElements::Element& e) const {
    return e.type.is_cell() && e.type.shape().dim == raw_.dim;
  }

  void make_cells() {
    std::vector<Index> points;
    for (const auto& e : deck_.elements.all) {
      if (!is_cell(e)) deck_.other_elements.emplace(e.id, 0);
      if (!is_cell(e)) continue;
      points.clear();
      for (int i = 0; i < e.type.shape().n_points; ++i)
        points.push_back(point_of(e, deck_.elements.nodes[e.first_node + std::size_t(i)]));
      if (!body_.cell_of_element.emplace(e.id, static_cast<Index>(raw_.cell_type.size())).second)
        throw Error("{}: element {} is defined twice.", lines_.place_of(e.mark), e.id);
      raw_.cell_type.push_back(e.type.cell);
      raw_.cell_points.push_row(points);
      body_.elements.push_back(&e);
    }
  }

  /// Names sets with listed members that the deck does not define.
  void name_missing() {
    std::vector<std::string> all;
    const auto check = [&](const char* kind, const std::vector<InpSet>& sets, const auto&... indices) {
      for (const InpSet& set : sets) {
        std::int64_t n = 0, missing = 0, first = 0;
        for (const InpRange& r : set.members) {
          if (!set.is_given || r.is_generated) continue;
          const std::int64_t count = (r.last - r.first) / r.step + 1;
          std::int64_t found = 0;
          (body_.visit({r}, indices, [&](Index) { ++found; }), ...);
          n += count, missing += count - found;
          for (std::int64_t id = r.first; first == 0 && found < count; id += r.step)
            if (!(indices.contains(id) || ...)) first = id;
        }
        if (missing > 0)
          all.push_back(
              fmt::format("{} of {} of {} '{}' (the first is {})", missing, n, kind, set.name, first));
      }
    };
    check("NSET", deck_.node_sets.all, deck_.point_of_node);
    check("ELSET", deck_.element_sets.all, body_.cell_of_element, deck_.other_elements);
    std::vector<InpSet> of_elements, of_nodes;
    for (const InpSurface& surface : deck_.surfaces) {
      of_nodes.push_back(surface.nodes);
      of_elements.emplace_back();
      for (const InpSurface::Part& part : surface.parts)
        of_elements.back().members.insert(of_elements.back().members.end(), part.elements.members.begin(),
                                          part.elements.members.end());
      for (InpSet* set : {&of_nodes.back(), &of_elements.back()})
        set->name = surface.name, set->is_given = true;
    }
    check("SURFACE", of_nodes, deck_.point_of_node);
    check("SURFACE", of_elements, body_.cell_of_element, deck_.other_elements);
    if (!all.empty())
      log::warn("'{}': members of sets are not defined in the deck: {}.", lines_.name(), beginning_of(all));
  }

  /// Removes midside and reference nodes. The others keep their order.
  void drop_unused() {
    std::vector<Index> renumbered(raw_.points.size(), -1);
    for (const Index p : raw_.cell_points.index) renumbered[std::size_t(p)] = 0;
    Index n = 0;
    for (std::size_t p = 0; p < renumbered.size(); ++p)
      if (renumbered[p] == 0) {
        raw_.points[std::size_t(n)] = raw_.points[p];
        renumbered[p] = n++;
      }
    raw_.points.resize(std::size_t(n));
    for (Index& p : raw_.cell_points.index) p = renumbered[std::size_t(p)];
    for (auto& [id, point] : deck_.point_of_node) point = renumbered[std::size_t(point)];
    std::erase_if(deck_.point_of_node, [](const auto& node) { return node.second < 0; });
  }

  /// Sets zones by *SOLID SECTION, else by the ELSET of the *ELEMENT.
  void find_zones() {
    raw_.cell_zone.assign(raw_.cell_type.size(), -1);
    for (const InpSet& section : deck_.sections) {
      const std::string& name = section.name;
      const int zone = number_in(raw_.zones, zones_, name);
      body_.visit(section.members, body_.cell_of_element, [&](Index cell) {
        int& of_cell = raw_.cell_zone[std::size_t(cell)];
        if (of_cell >= 0 && of_cell != zone)
          throw Error("{}: element {} has two sections, '{}' and '{}'.",
                      lines_.place_of(body_.elements[std::size_t(cell)]->mark),
                      body_.elements[std::size_t(cell)]->id, raw_.zones[std::size_t(of_cell)], name);
        of_cell = zone;
      });
    }
    for (std::size_t c = 0; c < raw_.cell_zone.size(); ++c) {
      if (raw_.cell_zone[c] >= 0) continue;
      const std::string& set = deck_.elements.groups[body_.elements[c]->group];
      raw_.cell_zone[c] = number_in(raw_.zones, zones_, set.empty() ? "default" : set);
    }
  }

  void report(std::size_t inner) const {
    if (deck_.second_order > 0)
      log::info(
          "'{}': {} second-order elements are reduced to their corners; compensate with about half the "
          "element size.",
          lines_.name(), deck_.second_order);
    if (inner > 0)
      log::info("'{}': {} faces of surfaces lie between two cells and belong to no patch.", lines_.name(),
                inner);
    const auto words = [](const std::set<std::string>& all) {
      return beginning_of({all.begin(), all.end()});
    };
    if (!deck_.passed_over.empty())
      log::info("'{}': only the mesh is read; skipped: {}.", lines_.name(), words(deck_.passed_over));
    if (!deck_.connections.empty())
      log::warn("'{}': parts of the mesh are connected by {}, which is not read.", lines_.name(),
                words(deck_.connections));
  }

  InpLines& lines_;
  InpBody body_;
  InpDeck& deck_ = body_.deck;
  RawMesh& raw_ = body_.raw;
  std::map<std::string, int> zones_;  // numbers by their names in capitals
};

}  // namespace

RawMesh read_inp(const std::filesystem::path& file) {
  InpLines lines(file);
  return InpMesh(lines).make();
}

}  // namespace couplet::mesh
