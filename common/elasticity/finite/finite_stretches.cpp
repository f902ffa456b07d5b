// SPDX-License-Identifier: Apache-2.0
// Thermal stretches of faces, of the edges they share with, of cells.
#include "common/elasticity/finite/finite_kernel_of.hpp"

namespace couplet::elastic {

template <int D>
void FiniteKernelOf<D>::set_stretch(std::span<const double> of_faces) {
  swelling_.clear();
  for (finite::Group<D>& group : groups_) {
    group.stretch.assign(of_faces.empty() ? 0 : group.blocks.size(), Four{} + 1.0);
    for (std::size_t i = 0; i < group.stretch.size(); ++i)
      for (int k = 0; k < 4; ++k)
        if (group.blocks[i].face[k] >= 0)
          group.stretch[i][k] = of_faces[std::size_t(group.blocks[i].face[k])];
  }
  if (edges_) of_faces.empty() ? edges_->forget_stretch() : stretch_edges();
  if (of_faces.empty() || of_cells_.empty()) return;
  swelling_.assign(volume_.size(), 0);
  const Index n = mesh_.cells.n_owned();
  for (Index f = 0; f < mesh_.n_flux_faces(); ++f) {
    const auto [here, there] = pyramids(mesh_, rows_.geometry(), f);
    const double theta = of_faces[std::size_t(f)], cube = theta * theta * theta;
    if (mesh_.owner[f] < n) swelling_[mesh_.owner[f]] += here * cube;
    if (f < mesh_.n_interior && mesh_.neighbour[f] < n) swelling_[mesh_.neighbour[f]] += there * cube;
  }
  for (std::size_t c = 0; c < swelling_.size(); ++c) swelling_[c] /= volume_[c];
}

/// The mean over the faces round an edge, as that of F. Collective.
template <int D>
void FiniteKernelOf<D>::stretch_edges() {
  edges_->clear();
  for (const finite::Group<D>& group : groups_)
    for (std::size_t i = 0; i < group.edges.size(); ++i)
      for (int k = 0; k < 4; ++k)
        for (const Index e : group.edges[i][std::size_t(k)])
          edges_->at(e)[0] += SharedEdges::share / 3 * group.blocks[i].volume[k] * (group.stretch[i][k] - 1);
  edges_->finish_means();
  edges_->take_stretch();
}

template void FiniteKernelOf<2>::set_stretch(std::span<const double>);
template void FiniteKernelOf<2>::stretch_edges();

template void FiniteKernelOf<3>::set_stretch(std::span<const double>);
template void FiniteKernelOf<3>::stretch_edges();

}  // namespace couplet::elastic
