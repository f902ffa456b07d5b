// SPDX-License-Identifier: Apache-2.0
#include "common/io/numbering.hpp"

#include <array>
#include <cstdint>

#include "common/base/error.hpp"
#include "common/parallel/collective.hpp"

namespace couplet::io {
namespace {

/// FNV-1a over the numbers of the mesh file, cut to what a double holds exactly.
double number_of(const mesh::Mesh& mesh) {
  std::uint64_t hash = 14695981039346656037ULL;
  for (const auto* ids : {&mesh.cell_id, &mesh.point_id, &mesh.boundary_id})
    for (const GlobalIndex id : *ids) hash = (hash ^ static_cast<std::uint64_t>(id)) * 1099511628211ULL;
  return static_cast<double>(hash >> 11);
}

}  // namespace

void write_numbering(CheckpointWriter& file, const mesh::Mesh& mesh) {
  file.write("numbering", std::array{number_of(mesh)});
}

void check_numbering(CheckpointReader& file, const mesh::Mesh& mesh) {
  const std::vector<double> then = file.read("numbering");
  const bool differs = then.size() != 1 || then[0] != number_of(mesh);
  if (parallel::max(mesh.comm, differs ? 1. : 0.) > 0)
    throw Error(
        "The checkpoint was written with another distribution or order of the cells: with another version "
        "of the partitioner or of gmsh. It cannot be continued with this mesh on these ranks.");
}

}  // namespace couplet::io
