// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "common/base/error.hpp"
#include "common/base/text.hpp"
#include "common/log/log.hpp"
#include "common/mesh/inp/inp_patches.hpp"
#include "common/mesh/load.hpp"

namespace couplet::mesh {
namespace {

constexpr std::size_t most_words = 20;  // in a message

/// From the deck to cells, zones and patches.
class InpMesh {
 public:
  explicit InpMesh(InpLines& lines) : lines_(lines), body_{lines, read_inp_deck(lines), {}, {}, {}} {}

  RawMesh make() {
    raw_.dim = 2;
    for (const auto& e : deck_.elements.all)
      if (e.type.use == InpType::Use::cell && e.type.shape->dim == 3) raw_.dim = 3;
    raw_.points = std::move(deck_.points);
    make_cells();
    if (raw_.cell_type.empty())
      throw Error("{}: the deck has no solid elements (C3D4, C3D8, CPS4, ...).", lines_.name());
    drop_unused();
    find_zones();
    report(name_patches(body_));
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
    return e.type.use == InpType::Use::cell && e.type.shape->dim == raw_.dim;
  }

  void make_cells() {
    std::vector<Index> points;
    for (const auto& e : deck_.elements.all) {
      if (!is_cell(e)) continue;
      points.clear();
      for (int i = 0; i < e.type.shape->n_corners; ++i)
        points.push_back(point_of(e, deck_.elements.nodes[e.first_node + std::size_t(i)]));
      if (!body_.cell_of_element.emplace(e.id, static_cast<Index>(raw_.cell_type.size())).second)
        throw Error("{}: element {} is defined twice.", lines_.place_of(e.mark), e.id);
      raw_.cell_type.push_back(e.type.shape->cell);
      raw_.cell_points.push_row(points);
      body_.elements.push_back(&e);
    }
  }

  /// Nodes between corners and reference nodes have no part in the mesh. The order of the others stays.
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

  /// By *SOLID SECTION, else by the ELSET of the *ELEMENT.
  void find_zones() {
    raw_.cell_zone.assign(raw_.cell_type.size(), -1);
    for (const auto& [name, members] : deck_.sections) {
      const int zone = zones_.number_of(raw_.zones, name);
      body_.visit(members, body_.cell_of_element, [&](Index cell) {
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
      raw_.cell_zone[c] = zones_.number_of(raw_.zones, set.empty() ? "default" : set);
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
    std::vector<std::string> words;
    for (const auto& [word, n] : deck_.passed_over)
      if (words.size() < most_words) words.push_back(word);
    if (!words.empty())
      log::info("'{}': only the mesh is read; skipped: {}.", lines_.name(), base::join(words));
  }

  InpLines& lines_;
  InpBody body_;
  InpDeck& deck_ = body_.deck;
  RawMesh& raw_ = body_.raw;
  InpNames zones_;
};

}  // namespace

RawMesh read_inp(const std::filesystem::path& file) {
  InpLines lines(file);
  return InpMesh(lines).make();
}

}  // namespace couplet::mesh
