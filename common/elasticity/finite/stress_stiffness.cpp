// SPDX-License-Identifier: Apache-2.0
#include "common/elasticity/finite/stress_stiffness.hpp"

#include <algorithm>
#include <utility>

#include "common/base/processor_clones.hpp"
#include "common/elasticity/finite/finite_loops.hpp"
#include "common/parallel/collective.hpp"

namespace couplet::elastic {

namespace {

using FaceStress = StressStiffness::FaceStress;

/// Adds V G sigma of the faces.
template <int D>
[[gnu::always_inline]] inline void faces_loop(const FaceGroup& group, std::span<const FaceStress> of,
                                              const double* values, double* forces) {
  for (std::size_t i = 0; i < group.blocks.size(); ++i) {
    Four g[D][D], stress[D][D] = {};
    blocks::gradient<D>(group.blocks[i], values, g);
    for (int b = 0; b < D; ++b)
      for (int c = 0; c < D; ++c) {
        const Four sigma =
            blocks::wide(of[i][std::size_t(SharedEdges::of_strain[std::size_t(3 * b + c)])].data());
        for (int a = 0; a < D; ++a) stress[a][c] += g[a][b] * sigma;
      }
    blocks::push<D>(group.blocks[i], stress, forces);
  }
}

COUPLET_PROCESSOR_CLONES void plane_pass(const FaceGroup& group, std::span<const FaceStress> of,
                                         const double* values, double* forces) {
  faces_loop<2>(group, of, values, forces);
}
COUPLET_PROCESSOR_CLONES void space_pass(const FaceGroup& group, std::span<const FaceStress> of,
                                         const double* values, double* forces) {
  faces_loop<3>(group, of, values, forces);
}
COUPLET_PROCESSOR_CLONES void to_edges_pass(const FaceGroup& group, const double* values, double* edges) {
  finite::to_edges(group, values, edges);
}
COUPLET_PROCESSOR_CLONES void from_edges_pass(const FaceGroup& group, const double* edges, double* forces) {
  finite::from_edges(group, edges, forces);
}

}  // namespace

StressStiffness::StressStiffness(const mesh::Mesh& mesh, const ElasticOperator& rows, Prestress of)
    : space_(mesh, rows), loads_(std::move(of.loads)) {
  const SharedFaces shared = shared_faces(mesh, rows);
  if (parallel::any(mesh.comm, shared.n_mine > 0)) {
    edges_ = std::make_unique<SharedEdges>(mesh, rows, shared);
    find_edge_stresses(shared, of.stress, *edges_);
    for (Index e = 0; e < Index(edges_->n_edges()); ++e) edge_stress_.push_back(edge_tensor(*edges_, e));
    edge_value_.resize(edge_stress_.size() * SharedEdges::gradient_stride);
  }
  for (int i = 0; i < (edges_ ? 2 : 1); ++i) {
    StressGroup& group = groups_.emplace_back();
    static_cast<FaceGroup&>(group) =
        make_group(mesh, rows, shared, i == 0 ? nullptr : edges_.get(), [](Index) { return true; });
    group.stress.resize(group.blocks.size(), FaceStress{});
    for (std::size_t k = 0; k < group.faces.size(); ++k) {
      const FaceVolumes& volumes = group.volumes[k / 4];
      const Tensor3& s = of.stress[std::size_t(group.faces[k])];
      for (std::size_t j = 0; j < 9; ++j)
        group.stress[k / 4][std::size_t(SharedEdges::of_strain[j])][k % 4] =
            volumes.own[k % 4] * volumes.whole[k % 4] * s(Index(j) / 3, Index(j) % 3);
    }
  }
}

void StressStiffness::apply(std::span<const double> x, std::span<double> y) {
  space_.fill(x, {});
  space_.clear_forces();
  const auto pass = space_.mesh().dim == 2 ? plane_pass : space_pass;
  for (const StressGroup& group : groups_) pass(group, group.stress, space_.values(), space_.forces());
  if (edges_) push_edges();
  add_blocks(space_, loads_, 1);
  space_.collect();
  space_.take_rows({}, {}, y);
}

/// Multiplies the mean gradients of the edges by their stress.
void StressStiffness::push_edges() {
  std::ranges::fill(edge_value_, 0);
  for (const StressGroup& group : groups_) to_edges_pass(group, space_.values(), edge_value_.data());
  edges_->finish_gradients(edge_value_);
  for (std::size_t e = 0; e < edge_stress_.size(); ++e) {
    Eigen::Map<Eigen::Matrix<double, 3, 3, Eigen::RowMajor>> g(edge_value_.data() +
                                                               e * SharedEdges::gradient_stride);
    g = (g * edge_stress_[e]).eval();
  }
  for (const StressGroup& group : groups_) from_edges_pass(group, edge_value_.data(), space_.forces());
}

}  // namespace couplet::elastic
