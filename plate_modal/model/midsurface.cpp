// SPDX-License-Identifier: Apache-2.0
#include "plate_modal/model/midsurface.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "common/base/error.hpp"

namespace couplet::plate {
namespace {

double cross(const Vec2& a, const Vec2& b) { return a.x() * b.y() - a.y() * b.x(); }

/// Twice the area of the smallest corner triangle, positive if the cell turns counter-clockwise and bulges
/// everywhere.
double least_corner(const Midsurface& s, std::span<const Index> cell) {
  double least = std::numeric_limits<double>::infinity();
  const std::size_t n = cell.size();
  for (std::size_t i = 0; i < n; ++i) {
    const Vec2 &a = s.points[cell[i]], &b = s.points[cell[(i + 1) % n]], &c = s.points[cell[(i + 2) % n]];
    least = std::min(least, cross(b - a, c - a));
  }
  return least;
}

/// The model lies in the plane of the mesh's x and y, and 'placement' says where that is in space: a mesh that stands
/// in another plane, or is no plane, would be seen from above only.
void refuse_out_of_plane(const mesh::RawMesh& raw) {
  constexpr double tolerance =
      1e-6;  // of the mesh's size: coordinates of a file have no more digits than this
  std::vector<Index> used;
  for (Index c = 0; c < raw.cell_points.size(); ++c)
    for (const Index p : raw.cell_points[c]) used.push_back(p);
  if (used.empty()) return;
  Vec3 low = raw.points[used.front()], high = low;
  Index farthest = used.front();
  for (const Index p : used) {
    const Vec3& x = raw.points[p];
    low = low.cwiseMin(x), high = high.cwiseMax(x);
    if (std::abs(x.z()) > std::abs(raw.points[farthest].z())) farthest = p;
  }
  const Vec3& x = raw.points[farthest];
  if (std::abs(x.z()) <= tolerance * (high - low).norm()) return;
  throw Error(
      "The mid-surface does not lie in the plane z = 0: its z ranges from {:.6g} to {:.6g} m, with the "
      "largest distance at ({:.6g}, {:.6g}, {:.6g}). Mesh the plate in that plane and position it with "
      "'placement'; curved or folded sheets are not supported.",
      low.z(), high.z(), x.x(), x.y(), x.z());
}

/// Adds points and cells; returns the new number of each point of the mesh.
std::vector<Index> add_cells(const mesh::RawMesh& raw, Midsurface& s) {
  std::vector<Index> number(raw.points.size(), -1);
  for (Index c = 0; c < raw.cell_points.size(); ++c)
    for (const Index p : raw.cell_points[c]) number[p] = 0;
  for (std::size_t p = 0; p < raw.points.size(); ++p) {
    if (number[p] < 0) continue;
    number[p] = static_cast<Index>(s.points.size());
    s.points.emplace_back(raw.points[p].x(), raw.points[p].y());
  }
  for (Index c = 0; c < raw.cell_points.size(); ++c) {
    std::vector<Index> cell;
    for (const Index p : raw.cell_points[c]) cell.push_back(number[p]);
    if (least_corner(s, cell) <= 0) std::ranges::reverse(cell);
    if (!(least_corner(s, cell) > 0)) {
      const Vec2& x = s.points[cell.front()];
      throw Error("The cell {} of the mid-surface at ({:.6g}, {:.6g}) has zero area or a re-entrant corner.",
                  c + 1, x.x(), x.y());
    }
    s.cells.push_row(cell);
  }
  s.zone = raw.cell_zone;
  s.zone.resize(s.cells.size(), 0);
  s.zones = raw.zones;
  if (s.zones.empty()) s.zones = {"plate"};
  return number;
}

std::map<std::pair<Index, Index>, Index> element_of_edges(const mesh::RawMesh& raw,
                                                          const std::vector<Index>& number) {
  std::map<std::pair<Index, Index>, Index> element;
  for (Index e = 0; e < raw.boundary_points.size(); ++e) {
    const auto ends = raw.boundary_points[e];
    const auto [found, is_new] = element.emplace(std::minmax(number[ends[0]], number[ends[1]]), e);
    const int patch = raw.boundary_patch[found->second];
    if (is_new || patch == raw.boundary_patch[e]) continue;
    const Vec3 middle = 0.5 * (raw.points[ends[0]] + raw.points[ends[1]]);
    throw Error(
        "The edge of the mid-surface at ({:.6g}, {:.6g}) belongs to two patches, '{}' and '{}', but can "
        "have only one boundary condition. Put each curve into exactly one physical curve.",
        middle.x(), middle.y(), raw.patches[patch], raw.patches[raw.boundary_patch[e]]);
  }
  return element;
}

/// Edges of a patch that are not on the outline would hold nothing, whatever their entry says.
void refuse_inside(const Midsurface& s, const mesh::RawMesh& raw,
                   const std::map<std::pair<Index, Index>, Index>& elements,
                   const std::map<std::pair<Index, Index>, int>& uses) {
  for (const auto& [edge, element] : elements) {
    const auto found = uses.find(edge);
    if (found == uses.end() || found->second < 2) continue;
    const Vec2 middle = 0.5 * (s.points[edge.first] + s.points[edge.second]);
    throw Error(
        "The patch '{}' has an edge inside the mid-surface, at ({:.6g}, {:.6g}). Only edges of the outline "
        "can be held: remove the curve from the physical curves, or cut a slit along it.",
        s.patches[raw.boundary_patch[element]], middle.x(), middle.y());
  }
}

}  // namespace

Midsurface midsurface_of(const mesh::RawMesh& raw, std::span<const int> curves) {
  Midsurface s;
  s.patches = raw.patches;
  refuse_out_of_plane(raw);
  const std::vector<Index> number = add_cells(raw, s);
  std::map<std::pair<Index, Index>, int> uses;
  for (Index c = 0; c < s.cells.size(); ++c)
    for (std::size_t i = 0, n = s.cells[c].size(); i < n; ++i)
      ++uses[std::minmax(s.cells[c][i], s.cells[c][(i + 1) % n])];
  const auto elements = element_of_edges(raw, number);
  refuse_inside(s, raw, elements, uses);
  for (Index c = 0; c < s.cells.size(); ++c)
    for (std::size_t i = 0, n = s.cells[c].size(); i < n; ++i) {
      const Index from = s.cells[c][i], to = s.cells[c][(i + 1) % n];
      const std::pair<Index, Index> edge = std::minmax(from, to);
      const Vec2 middle = 0.5 * (s.points[from] + s.points[to]);
      if (uses[edge] > 2)
        throw Error("{} cells of the mid-surface meet at the edge at ({:.6g}, {:.6g}); it must be one sheet.",
                    uses[edge], middle.x(), middle.y());
      if (uses[edge] == 2) continue;
      const auto found = elements.find(edge);
      if (found == elements.end())
        throw Error(
            "The edge of the mid-surface at ({:.6g}, {:.6g}) belongs to no patch. Put the whole outline "
            "into physical curves.",
            middle.x(), middle.y());
      const Index e = found->second;
      s.edges.push_back({from, to, c, raw.boundary_patch[e], curves.empty() ? -1 : curves[e]});
    }
  return s;
}

}  // namespace couplet::plate
