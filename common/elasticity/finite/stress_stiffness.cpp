// SPDX-License-Identifier: Apache-2.0
#include "common/elasticity/finite/stress_stiffness.hpp"

#include <algorithm>
#include <utility>

#include "common/elasticity/finite/finite_loops.hpp"
#include "common/parallel/collective.hpp"

namespace couplet::elastic {

StressStiffness::StressStiffness(const mesh::Mesh& mesh, const ElasticOperator& rows, Prestress of)
    : space_(mesh, rows), of_(std::move(of)) {
  const SharedFaces shared = shared_faces(mesh, rows);
  if (parallel::any(mesh.comm, shared.n_mine > 0)) {
    edges_ = std::make_unique<SharedEdges>(mesh, rows, shared);
    find_edge_stresses(shared, of_.stress, *edges_);
    for (Index e = 0; e < Index(edges_->n_edges()); ++e) edge_stress_.push_back(edge_tensor(*edges_, e));
    edge_value_.resize(edge_stress_.size() * SharedEdges::gradient_stride);
  }
  for (int i = 0; i < (edges_ ? 2 : 1); ++i)
    groups_.push_back(
        make_group(mesh, rows, shared, i == 0 ? nullptr : edges_.get(), [](Index) { return true; }));
}

void StressStiffness::apply(std::span<const double> x, std::span<double> y) {
  space_.fill(x, {});
  space_.clear_forces();
  for (const FaceGroup& group : groups_) space_.mesh().dim == 2 ? push<2>(group) : push<3>(group);
  if (edges_) push_edges();
  add_blocks(space_, of_.loads, 1);
  space_.collect();
  space_.take_rows({}, {}, y);
}

/// Adds V G sigma of the faces.
template <int D>
void StressStiffness::push(const FaceGroup& group) {
  for (std::size_t i = 0; i < group.blocks.size(); ++i) {
    Four g[D][D], stress[D][D] = {};
    blocks::gradient<D>(group.blocks[i], space_.values(), g);
    for (int b = 0; b < D; ++b)
      for (int c = 0; c < D; ++c) {
        Four sigma{};
        for (int k = 0; k < 4; ++k) {
          const Index f = group.volumes[i].face[k];
          if (f >= 0)
            sigma[k] = group.volumes[i].own[k] * group.volumes[i].whole[k] * of_.stress[std::size_t(f)](b, c);
        }
        for (int a = 0; a < D; ++a) stress[a][c] += g[a][b] * sigma;
      }
    blocks::push<D>(group.blocks[i], stress, space_.forces());
  }
}

/// Multiplies the mean gradients of the edges by their stress.
void StressStiffness::push_edges() {
  std::ranges::fill(edge_value_, 0);
  for (const FaceGroup& group : groups_) finite::to_edges(group, space_.values(), edge_value_.data());
  edges_->finish_gradients(edge_value_);
  for (std::size_t e = 0; e < edge_stress_.size(); ++e) {
    Eigen::Map<Eigen::Matrix<double, 3, 3, Eigen::RowMajor>> g(edge_value_.data() +
                                                               e * SharedEdges::gradient_stride);
    g = (g * edge_stress_[e]).eval();
  }
  for (const FaceGroup& group : groups_) finite::from_edges(group, edge_value_.data(), space_.forces());
}

}  // namespace couplet::elastic
