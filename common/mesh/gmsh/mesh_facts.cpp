// SPDX-License-Identifier: Apache-2.0
#include "common/mesh/gmsh/mesh_facts.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "common/mesh/gmsh/geo_script.hpp"
#include "common/mesh/gmsh/gmsh.hpp"

namespace couplet::mesh {

double MeshFacts::smallest_side() const { return dim == 2 ? std::min(size[0], size[1]) : size.minCoeff(); }
double MeshFacts::largest_side() const { return size.maxCoeff(); }

MeshFacts facts_of(const RawMesh& raw) {
  MeshFacts facts;
  facts.dim = raw.dim;
  facts.cells = raw.cell_type.size();
  if (raw.points.empty() || facts.cells == 0) return facts;
  Vec3 low = raw.points.front(), high = low;
  for (const Vec3& x : raw.points) low = low.cwiseMin(x), high = high.cwiseMax(x);
  facts.size = high - low;
  double volume = 1;
  for (int a = 0; a < raw.dim; ++a) volume *= facts.size[a];
  facts.mean_cell = std::pow(volume / double(facts.cells), 1.0 / raw.dim);
  double shortest = std::numeric_limits<double>::infinity();
  for (Index c = 0; c < Index(facts.cells); ++c) {
    const auto points = raw.cell_points[c];
    for (std::size_t i = 0; i < points.size(); ++i)
      for (std::size_t j = i + 1; j < points.size(); ++j)
        shortest = std::min(shortest, (raw.points[points[i]] - raw.points[points[j]]).squaredNorm());
  }
  facts.shortest_edge = std::sqrt(shortest);
  return facts;
}

namespace {

RawMesh read_raw(const std::filesystem::path& file, const MeshParameters& parameters) {
  if (file.extension() != ".geo") return read_finished_mesh(file);
  const GeoScript script = read_geo(file);
  const bool is_solid =
      !script.groups.at(3) || !script.groups.at(3)->empty();  // nothing: some name is computed
  return read_msh(mesh_geo(file, is_solid ? 3 : 2, parameters));
}

}  // namespace

MeshFacts facts_of_file(const std::filesystem::path& file, const MeshParameters& parameters, double scale) {
  MeshFacts facts = facts_of(read_raw(file, parameters));
  facts.size *= scale;
  facts.shortest_edge *= scale;
  facts.mean_cell *= scale;
  return facts;
}

}  // namespace couplet::mesh
