// SPDX-License-Identifier: Apache-2.0
#include "common/modes/surface_parts.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <map>
#include <utility>

#include "common/base/disjoint_sets.hpp"
#include "common/base/point_tree.hpp"

namespace couplet::modes {
namespace {

/// A face that goes along an edge, and whether from its smaller to its larger number.
struct Use {
  Index face;
  bool forward;
};
using Edges = std::map<std::pair<Index, Index>, std::vector<Use>>;

Edges edges_of(const mesh::Csr& faces) {
  Edges edges;
  for (Index f = 0; f < faces.size(); ++f) {
    const auto corners = faces[f];
    for (std::size_t i = 0; i < corners.size(); ++i) {
      const Index from = corners[i], to = corners[(i + 1) % corners.size()];
      edges[std::minmax(from, to)].push_back({f, from < to});
    }
  }
  return edges;
}

/// How far apart vertices may stand that are the same one [m].
double same_place(const ModalModel& model) {
  double shortest = std::numeric_limits<double>::infinity();
  for (Index f = 0; f < model.faces.size(); ++f) {
    const auto corners = model.faces[f];
    for (std::size_t i = 0; i < corners.size(); ++i)
      shortest = std::min(
          shortest, (model.vertices[corners[i]] - model.vertices[corners[(i + 1) % corners.size()]]).norm());
  }
  return std::min(1e-6 * extent_of(model).norm(), 0.01 * shortest);
}

/// Of each vertex the smallest number that stands at its place.
std::vector<Index> places_of(const ModalModel& model) {
  const double distance = same_place(model);
  const base::PointTree tree(model.vertices);
  std::vector<Index> place(model.vertices.size());
  for (std::size_t v = 0; v < place.size(); ++v) {
    place[v] = Index(v);
    for (const Index other : tree.within(model.vertices[v], distance))
      place[v] = std::min(place[v], place[std::size_t(std::min(other, Index(v)))]);
  }
  return place;
}

}  // namespace

WeldedSurface weld(const ModalModel& model) {
  WeldedSurface welded;
  const std::vector<Index> place = places_of(model);
  for (Index f = 0; f < model.faces.size(); ++f) {
    std::vector<Index> corners;
    for (const Index v : model.faces[f])
      if (std::ranges::find(corners, place[std::size_t(v)]) == corners.end())
        corners.push_back(place[std::size_t(v)]);
    if (corners.size() < 3) corners.clear();
    welded.faces.push_row(corners);
  }
  // Bodies that touch have edges of four faces: there only faces with the same vertices belong together.
  base::DisjointSets groups(Index(model.faces.size()));
  for (const auto& [edge, uses] : edges_of(model.faces))
    for (const Use& use : uses) groups.join(uses.front().face, use.face);
  for (const auto& [edge, uses] : edges_of(welded.faces))
    if (uses.size() == 2) groups.join(uses[0].face, uses[1].face);
  std::map<Index, std::size_t> number;
  for (Index f = 0; f < model.faces.size(); ++f) {
    const auto [at, fresh] = number.try_emplace(groups.find(f), welded.part.size());
    if (fresh) welded.part.emplace_back();
    welded.part[at->second].push_back(f);
  }
  return welded;
}

std::string neighbour_problem_of(const ModalModel& model, const WeldedSurface& welded) {
  for (const auto& [edge, uses] : edges_of(welded.faces)) {
    if (uses.size() != 2 || uses[0].forward != uses[1].forward) continue;
    const Vec3 x = 0.5 * (model.vertices[edge.first] + model.vertices[edge.second]);
    return fmt::format(
        "faces {} and {} share an edge at ({:.4g}, {:.4g}, {:.4g}) and traverse it in the same direction: "
        "one of them is inside out",
        uses[0].face + 1, uses[1].face + 1, x.x(), x.y(), x.z());
  }
  return "";
}

}  // namespace couplet::modes
