// SPDX-License-Identifier: Apache-2.0
#include "common/mesh/inp/inp_patches.hpp"

#include <algorithm>
#include <array>

#include "common/mesh/topology.hpp"

namespace couplet::mesh {
namespace {

using Corners = std::array<Index, 4>;
constexpr Index none = -1;
/// Of the boundary that no surface and no set names.
constexpr const char* rest = "rest";

Corners key_of(std::span<const Index> points) {
  Corners key{none, none, none, none};
  std::ranges::copy(points, key.begin());
  std::ranges::sort(key);
  return key;
}

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

  std::size_t name() {
    for (const InpSurface& surface : deck_.surfaces) take_surface(surface);
    take_flat_elements();
    take_node_sets();
    name_rest();
    return inner_;
  }

 private:
  int number_of(const std::string& name) { return names_.number_of(raw_.patches, name); }

  /// Into outer_; none: it lies between two cells, or is a face of no cell.
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
      body_.visit(part.elements, body_.cell_of_element, [&](Index cell) {
        const InpShape& shape = *body_.elements[std::size_t(cell)]->type.shape;
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
    if (!surface.nodes.empty()) take_nodes(surface.nodes, patch, true);
  }

  /// Elements of one dimension less, as meshers write them for the groups of their surfaces: by the smallest *ELSET that they are in,
  /// else by that of their *ELEMENT.
  void take_flat_elements() {
    std::unordered_map<std::int64_t, Index> face_of_element;
    std::vector<Index> points;
    for (const auto& e : deck_.elements.all) {
      const int corners = e.type.use == InpType::Use::edge ? 2 : e.type.shape->n_corners;
      if ((e.type.use == InpType::Use::edge ? 1 : e.type.shape->dim) != raw_.dim - 1) continue;
      points.clear();
      for (int i = 0; i < corners; ++i) {
        const auto found = deck_.point_of_node.find(deck_.elements.nodes[e.first_node + std::size_t(i)]);
        if (found != deck_.point_of_node.end()) points.push_back(found->second);
      }
      const Index face = std::ssize(points) == corners ? outer_face(points) : none;
      if (face != none) face_of_element.emplace(e.id, face);
    }
    if (face_of_element.empty()) return;
    std::vector<std::pair<std::size_t, const InpSet*>> by_size;
    for (const InpSet& set : deck_.element_sets.all) {
      std::size_t n = set.is_given ? 0 : face_of_element.size();
      body_.visit(set.members, face_of_element, [&](Index) { ++n; });
      if (n > 0) by_size.emplace_back(n, &set);
    }
    std::ranges::stable_sort(by_size, {}, &std::pair<std::size_t, const InpSet*>::first);
    for (const auto& [n, set] : by_size)
      body_.visit(set->members, face_of_element, [&](Index face) {
        if (patch_of_face_[std::size_t(face)] == none) assign(face, number_of(set->name));
      });
  }

  /// Smaller sets first: "tip" within "top". A set of all points names nothing, and one with the name of a surface was the way
  /// to it.
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
      if (n >= 2 && n < raw_.points.size() && !names_.contains(set.name)) by_size.emplace_back(n, &set);
    }
    std::ranges::stable_sort(by_size, {}, &std::pair<std::size_t, const InpSet*>::first);
    for (const auto& [n, set] : by_size) take_nodes(set->members, number_of(set->name), false);
  }

  /// The faces all of whose points are in this set.
  void take_nodes(const std::vector<InpRange>& members, int patch, bool is_surface) {
    if (faces_of_point_.offset.size() == 1) find_faces_of_points();
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

  void find_faces_of_points() {
    marked_.assign(raw_.points.size(), none);
    std::vector<Index>& first = faces_of_point_.offset;
    first.assign(raw_.points.size() + 1, 0);
    for (const Index p : outer_.index) ++first[std::size_t(p) + 1];
    for (std::size_t p = 1; p < first.size(); ++p) first[p] += first[p - 1];
    faces_of_point_.index.resize(outer_.index.size());
    std::vector<Index> next(first.begin(), first.end() - 1);
    for (Index f = 0; f < outer_.size(); ++f)
      for (const Index p : outer_[f]) faces_of_point_.index[std::size_t(next[std::size_t(p)]++)] = f;
  }

  /// Patches without a face are left out.
  void name_rest() {
    for (Index f = 0; f < outer_.size(); ++f)
      if (patch_of_face_[std::size_t(f)] == none) patch_of_face_[std::size_t(f)] = number_of(rest);
    std::vector<int> renumbered(raw_.patches.size(), none);
    for (const int patch : patch_of_face_) renumbered[std::size_t(patch)] = 0;
    std::vector<std::string> kept;
    for (std::size_t p = 0; p < renumbered.size(); ++p) {
      if (renumbered[p] == none) continue;
      renumbered[p] = static_cast<int>(kept.size());
      kept.push_back(raw_.patches[p]);
    }
    raw_.patches = std::move(kept);
    for (int& patch : patch_of_face_) patch = renumbered[std::size_t(patch)];
    raw_.boundary_points = std::move(outer_);
    raw_.boundary_patch = std::move(patch_of_face_);
  }

  InpBody& body_;
  InpDeck& deck_;
  RawMesh& raw_;
  InpNames names_;
  Csr outer_;
  std::vector<std::pair<Corners, Index>> faces_;  // outer_ by its points, ascending
  std::vector<int> patch_of_face_;
  Csr faces_of_point_;
  std::vector<int> marked_;  // per point: the patch whose points were marked last
  std::size_t inner_ = 0;
};

}  // namespace

int InpNames::number_of(std::vector<std::string>& names, const std::string& name) {
  const auto [found, is_new] = numbers_.try_emplace(upper(name), static_cast<int>(names.size()));
  if (is_new) names.push_back(name);
  return found->second;
}

std::size_t name_patches(InpBody& body) { return InpPatches(body).name(); }

}  // namespace couplet::mesh
