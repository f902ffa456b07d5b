// SPDX-License-Identifier: Apache-2.0
// What the loops over faces read, made once.
#include <algorithm>

#include "common/elasticity/symmetric/symmetric_kernel.hpp"

namespace couplet::elastic {

template <int D>
SymmetricKernel<D>::SymmetricKernel(const mesh::Mesh& mesh, const ElasticOperator& rows)
    : SpaceKernel<D>(mesh, rows), mesh_(mesh), geometry_(rows.geometry()), rows_(rows) {
  make_faces();
  if (!rows.volume_by_cells()) return;
  volumes_ = make_volumes(mine_);
  shared_volumes_ = make_volumes(shared_mine_);
  pressure_.assign(space_.n_nodes(), 0);
  const std::vector<double> volume = pyramid_volumes(mesh, geometry_);
  for (Index c = 0; c < mesh.cells.n_owned(); ++c)
    bulk_.push_back(bulk_of_cells(rows.lame(c), rows.volume_strain()) / volume[c]);
}

template <int D>
std::vector<typename SymmetricKernel<D>::VolumeBlock> SymmetricKernel<D>::make_volumes(
    std::span<const Index> faces) const {
  std::vector<VolumeBlock> result((faces.size() + 3) / 4);
  for (std::size_t i = 0; i < result.size() * 4; ++i) {
    VolumeBlock& block = result[i / 4];
    block.from[i % 4] = block.to[i % 4] = 0;
    if (i >= faces.size()) continue;
    const auto [here, there] = pyramids(mesh_, geometry_, faces[i]);
    const double inverse = symmetric_face<D>(mesh_, rows_, faces[i]).inverse;
    block.from[i % 4] = here * inverse;
    block.to[i % 4] = there * inverse;
  }
  return result;
}

template <int D>
void SymmetricKernel<D>::make_faces() {
  std::vector<Index> shared_elsewhere;
  shared_index_.assign(D == 3 ? mesh_.n_flux_faces() : 0, -1);
  for (Index f = 0; f < mesh_.n_flux_faces(); ++f) {
    const bool is_mine = mesh_.owner[f] < mesh_.cells.n_owned();
    if (D == 3 && mesh_.face_points[f].size() == 3)
      (is_mine ? shared_mine_ : shared_elsewhere).push_back(f);
    else if (is_mine)
      mine_.push_back(f);
  }
  if (!mine_.empty()) blocks_ = make_blocks<D>(mesh_, rows_, mine_);
  elastic_ = make_elastic_blocks<D>(mesh_, rows_, mine_);
  shared_elastic_ = make_elastic_blocks<D>(mesh_, rows_, shared_mine_);
  const bool shares = D == 3 && parallel::any(mesh_.comm, !shared_mine_.empty());
  if (!shares) return;
  if (!shared_mine_.empty()) shared_blocks_ = make_blocks<D>(mesh_, rows_, shared_mine_);
  std::vector<Index> all = shared_mine_;
  all.insert(all.end(), shared_elsewhere.begin(), shared_elsewhere.end());
  std::vector<double> volume(all.size(), 0);
  shared_.resize(shared_blocks_.size());
  for (std::size_t i = 0; i < all.size(); ++i) {
    shared_index_[all[i]] = static_cast<Index>(i);
    if (i >= shared_mine_.size()) continue;
    const SymmetricFace<D> face = symmetric_face<D>(mesh_, rows_, all[i]);
    volume[i] = face.volume;
    SharedBlock& block = shared_[i / 4];
    block.inverse[i % 4] = face.inverse;
    block.part[i % 4] = SharedEdges::share * face.volume / 3;
    block.weight[i % 4] = SharedEdges::share * face.volume * face.inverse / 3;
  }
  edges_ = std::make_unique<SharedEdges>(mesh_, rows_, all, volume);
  for (std::size_t i = 0; i < shared_.size() * 4; ++i) {
    const bool is_filling = i >= shared_mine_.size();
    if (is_filling)
      shared_[i / 4].inverse[i % 4] = shared_[i / 4].part[i % 4] = shared_[i / 4].weight[i % 4] = 0;
    shared_[i / 4].edges[i % 4] = edges_->edges_of(is_filling ? 0 : i);
  }
}

template SymmetricKernel<2>::SymmetricKernel(const mesh::Mesh&, const ElasticOperator&);
template SymmetricKernel<3>::SymmetricKernel(const mesh::Mesh&, const ElasticOperator&);

}  // namespace couplet::elastic
