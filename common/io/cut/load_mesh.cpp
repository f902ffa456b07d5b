// SPDX-License-Identifier: Apache-2.0
#include "common/io/cut/load_mesh.hpp"

#include <cmath>

#include "common/base/error.hpp"
#include "common/io/cut/cut_mesh.hpp"

namespace couplet::io {

mesh::LoadedMesh load_mesh(MPI_Comm comm, const std::filesystem::path& file, int dim,
                           const mesh::MeshParameters& parameters,
                           const std::vector<std::array<std::string, 2>>& periodic,
                           const std::vector<std::vector<std::string>>& materials, bool find_wide_points,
                           double scale) {
  if (!is_cut_mesh(file))
    return mesh::load_mesh(comm, file, dim, parameters, periodic, materials, find_wide_points, scale);
  if (!parameters.empty())
    throw Error(
        "The mesh '{}' is already meshed, so 'mesh-parameters' cannot change it. Remove them, or give the .geo it "
        "was made from.",
        file.string());
  mesh::MeshBlock block = read_cut_mesh(comm, file);
  if (block.dim != dim)
    throw Error("The mesh '{}' is {}-dimensional, but the case sets 'dimension: {}'.", file.string(),
                block.dim, dim);
  block.periodic = periodic;
  block.materials = materials;
  block.find_wide_points = find_wide_points;
  return mesh::load_block(comm, std::move(block), file, scale);
}

mesh::MeshFacts facts_of_file(const std::filesystem::path& file, const mesh::MeshParameters& parameters,
                              double scale) {
  if (!is_cut_mesh(file)) return mesh::facts_of_file(file, parameters, scale);
  const CutMeshFacts cut = read_cut_mesh_facts(file);
  mesh::MeshFacts facts;
  facts.dim = cut.dim;
  facts.cells = std::size_t(cut.cells);
  facts.size = cut.size * scale;
  facts.shortest_edge = cut.shortest_edge * scale;
  double volume = 1;
  for (int a = 0; a < cut.dim; ++a) volume *= facts.size[a];
  facts.mean_cell = std::pow(volume / double(std::max<std::size_t>(1, facts.cells)), 1.0 / cut.dim);
  return facts;
}

}  // namespace couplet::io
