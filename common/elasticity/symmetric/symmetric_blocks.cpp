// SPDX-License-Identifier: Apache-2.0
#include "common/elasticity/symmetric/symmetric_blocks.hpp"

namespace couplet::elastic {

FaceGroup make_group(const mesh::Mesh& mesh, const ElasticOperator& rows, std::vector<Index> faces) {
  FaceGroup group{.faces = std::move(faces), .blocks = {}, .volumes = {}, .edges = {}};
  group.blocks.resize((group.faces.size() + 3) / 4, FaceBlock{});
  group.volumes.resize(group.blocks.size(), FaceVolumes{});
  for (std::size_t i = 0; i < group.blocks.size() * 4; ++i) {
    FaceBlock& block = group.blocks[i / 4];
    FaceVolumes& volumes = group.volumes[i / 4];
    const std::size_t k = i % 4;
    const bool is_filling = i >= group.faces.size();
    const Index f = is_filling ? group.faces.back() : group.faces[i];
    const FaceRows face = symmetric_rows(mesh, rows, f);
    for (std::size_t j = 0; 2 * j < std::size_t(face.n); ++j) {
      block.plus[j][k] = face.row[j == 0 ? 1 : 2 * j].place;
      block.minus[j][k] = face.row[j == 0 ? 0 : 2 * j + 1].place;
    }
    volumes.face[k] = is_filling ? -1 : f;
    if (is_filling) continue;
    for (std::size_t j = 0; j < std::size_t(mesh.dim); ++j)
      for (int a = 0; a < mesh.dim; ++a) block.b[j][a][k] = face.row[j == 0 ? 1 : 2 * j].b[a];
    const auto [here, there] = pyramids(mesh, rows.geometry(), f);
    volumes.whole[k] = face.volume;
    volumes.here[k] = here / face.volume;
    volumes.there[k] = there / face.volume;
  }
  return group;
}

}  // namespace couplet::elastic
