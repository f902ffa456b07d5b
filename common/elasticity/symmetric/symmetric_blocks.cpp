// SPDX-License-Identifier: Apache-2.0
#include "common/elasticity/symmetric/symmetric_blocks.hpp"

#include "common/elasticity/elastic_nodes.hpp"

namespace couplet::elastic {

template <int D>
void set_geometry(const mesh::Mesh& mesh, const SymmetricFace<D>& face, Index f, std::size_t k,
                  bool is_filling, BlockGeometry<D>& block) {
  block.from[k] = mesh.owner[f];
  block.to[k] = f < mesh.n_interior ? mesh.neighbour[f] : mesh.cells.n_local() + f - mesh.n_interior;
  for (int a = 0; a < D; ++a) {
    block.vector[0][a][k] = is_filling ? 0 : face.area[a];
    for (int j = 0; j < D - 1; ++j) block.vector[j + 1][a][k] = is_filling ? 0 : face.across[j][a];
  }
  for (int j = 0; j < D - 1; ++j) {
    block.plus[j][k] = face.plus[j];
    block.minus[j][k] = face.minus[j];
  }
}

template void set_geometry<2>(const mesh::Mesh&, const SymmetricFace<2>&, Index, std::size_t, bool,
                              BlockGeometry<2>&);
template void set_geometry<3>(const mesh::Mesh&, const SymmetricFace<3>&, Index, std::size_t, bool,
                              BlockGeometry<3>&);

template <int D>
std::vector<FaceBlock<D>> make_blocks(const mesh::Mesh& mesh, const ElasticOperator& rows,
                                      std::span<const Index> faces) {
  constexpr int width = BlockGeometry<D>::width;
  std::vector<FaceBlock<D>> result((faces.size() + width - 1) / width);
  for (std::size_t i = 0; i < result.size() * width; ++i) {
    FaceBlock<D>& block = result[i / width];
    const std::size_t k = i % width;
    const bool is_filling = i >= faces.size();
    const Index f = faces[is_filling ? 0 : i];
    const SymmetricFace<D> face = symmetric_face<D>(mesh, rows, f);
    const LameConstants whole = face_lame(mesh, rows, f);
    const LameConstants lame = part_of_faces(whole, rows.volume_strain());
    const double scale = is_filling ? 0 : face.volume * face.inverse * face.inverse;
    block.mu[k] = lame.mu * scale;
    block.lambda[k] = lame.lambda * scale;
    set_geometry<D>(mesh, face, f, k, is_filling, block);
  }
  return result;
}

template <int D>
std::vector<ElasticBlock<D>> make_elastic_blocks(const mesh::Mesh& mesh, const ElasticOperator& rows,
                                                 std::span<const Index> faces) {
  if (!rows.is_anisotropic()) return {};
  constexpr int entry[2][6] = {{0, 1, 3, 0, 0, 0},
                               {0, 1, 2, 3, 4, 5}};  // of the matrix; in the plane without z
  std::vector<ElasticBlock<D>> result((faces.size() + 3) / 4);
  for (std::size_t i = 0; i < result.size() * 4; ++i) {
    const bool is_filling = i >= faces.size();
    const Index f = faces[is_filling ? 0 : i];
    const SymmetricFace<D> face = symmetric_face<D>(mesh, rows, f);
    const double scale = is_filling ? 0 : face.volume * face.inverse * face.inverse;
    const ElasticMatrix c = face_matrix(mesh, rows, f);
    int at = 0;
    for (int a = 0; a < ElasticBlock<D>::size; ++a)
      for (int b = a; b < ElasticBlock<D>::size; ++b)
        result[i / 4].c[at++][i % 4] = scale * c(entry[D - 2][a], entry[D - 2][b]);
  }
  return result;
}

template std::vector<ElasticBlock<2>> make_elastic_blocks<2>(const mesh::Mesh&, const ElasticOperator&,
                                                             std::span<const Index>);
template std::vector<ElasticBlock<3>> make_elastic_blocks<3>(const mesh::Mesh&, const ElasticOperator&,
                                                             std::span<const Index>);
template std::vector<FaceBlock<2>> make_blocks<2>(const mesh::Mesh&, const ElasticOperator&,
                                                  std::span<const Index>);
template std::vector<FaceBlock<3>> make_blocks<3>(const mesh::Mesh&, const ElasticOperator&,
                                                  std::span<const Index>);

}  // namespace couplet::elastic
