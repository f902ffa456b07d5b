// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "common/base/error.hpp"
#include "common/base/text.hpp"
#include "common/mesh/topology.hpp"

namespace couplet::mesh {

std::vector<int> materials_of_cells(const RawMesh& raw) {
  if (raw.materials.empty()) return {};
  std::vector<int> of_zone(raw.zones.size(), -1);
  for (std::size_t m = 0; m < raw.materials.size(); ++m)
    for (const std::string& name : raw.materials[m]) {
      const auto zone = std::ranges::find(raw.zones, name);
      if (zone == raw.zones.end())
        throw Error("It has no zone '{}' for a material. {} The zones (physical {} of gmsh) are {}.", name,
                    base::did_you_mean(name, raw.zones, "zones"), raw.dim == 2 ? "surfaces" : "volumes",
                    base::join(raw.zones));
      int& material = of_zone[zone - raw.zones.begin()];
      if (material >= 0)
        throw Error("Its zone '{}' is assigned to two materials; each zone has exactly one.", name);
      material = static_cast<int>(m);
    }
  for (std::size_t z = 0; z < of_zone.size(); ++z)
    if (of_zone[z] < 0)
      throw Error("Its zone '{}' has no material; add it to the zones of a material. The zones are {}.",
                  raw.zones[z], base::join(raw.zones));
  if (raw.materials.size() == 1) return {};
  std::vector<int> result;
  for (const int zone : raw.cell_zone) result.push_back(of_zone[zone]);
  return result;
}

void split_materials(RawMesh& raw, Faces& faces, const std::vector<int>& cell_material) {
  if (cell_material.empty()) return;
  const auto is_bonded = [&](Index f) {
    return cell_material[faces.owner[f]] != cell_material[faces.neighbour[f]];
  };
  std::vector<Index> bonded;
  for (Index f = 0; f < faces.n_interior; ++f)
    if (is_bonded(f)) bonded.push_back(f);
  if (bonded.empty()) return;
  Faces split;
  split.n_interior = faces.n_interior - static_cast<Index>(bonded.size());
  const auto push = [&](Index owner, std::span<const Index> points) {
    split.owner.push_back(owner);
    split.points.push_row(points);
  };
  for (Index f = 0; f < faces.n_interior; ++f) {
    if (is_bonded(f)) continue;
    push(faces.owner[f], faces.points[f]);
    split.neighbour.push_back(faces.neighbour[f]);
  }
  for (Index f = faces.n_interior; f < faces.points.size(); ++f) push(faces.owner[f], faces.points[f]);
  split.patch = faces.patch;
  split.first_bonded = faces.n_boundary();
  for (const Index f : bonded) {
    push(faces.owner[f], faces.points[f]);
    std::vector<Index> turned(faces.points[f].begin(), faces.points[f].end());
    std::reverse(turned.begin() + 1, turned.end());
    if (raw.dim == 2) std::swap(turned[0], turned[1]);
    push(faces.neighbour[f], turned);
    split.patch.insert(split.patch.end(), 2, static_cast<int>(raw.patches.size()));
  }
  raw.patches.push_back("(between materials)");
  faces = std::move(split);
}

CellPairs connected_cells(const Faces& faces) {
  CellPairs pairs;
  pairs.first.assign(faces.owner.begin(), faces.owner.begin() + faces.n_interior);
  pairs.second = faces.neighbour;
  if (faces.first_bonded < 0) return pairs;
  for (Index b = 0; b + 1 < faces.n_boundary(); ++b) {
    const GlobalIndex side = faces.number_of_boundary(b) - faces.first_bonded;
    if (side < 0 || side % 2 == 1 || faces.number_of_boundary(b + 1) != faces.number_of_boundary(b) + 1)
      continue;
    pairs.first.push_back(faces.owner[faces.n_interior + b]);
    pairs.second.push_back(faces.owner[faces.n_interior + b + 1]);
  }
  return pairs;
}

}  // namespace couplet::mesh
