// SPDX-License-Identifier: Apache-2.0
#include "common/elasticity/finite/stress_stiffness.hpp"

#include <algorithm>
#include <utility>

#include "common/elasticity/finite/finite_loops.hpp"
#include "common/elasticity/symmetric/symmetric_space.hpp"
#include "common/parallel/collective.hpp"

namespace couplet::elastic {
namespace {

template <int D>
class StressStiffnessOf final : public StressStiffness {
 public:
  StressStiffnessOf(const mesh::Mesh& mesh, const ElasticOperator& rows, Prestress of)
      : space_(mesh, rows), pressure_(std::move(of.pressure)) {
    const SharedFaces shared = shared_faces(mesh, rows);
    if (parallel::any(mesh.comm, shared.n_mine > 0)) {
      edges_ = std::make_unique<SharedEdges>(mesh, rows, shared.faces, shared.volume);
      find_edge_stresses(shared, of.stress, *edges_);
      for (Index e = 0; e < Index(edges_->n_edges()); ++e) edge_stress_.push_back(edge_tensor(*edges_, e));
      edge_value_.resize(edge_stress_.size() * SharedEdges::gradient_stride);
    }
    for (int i = 0; i < (edges_ ? 2 : 1); ++i) {
      groups_.push_back(finite::make_group<D>(mesh, rows, shared, i == 0 ? nullptr : edges_.get(),
                                              [](Index) { return true; }));
      between_.emplace_back();
      for (const finite::FiniteBlock<D>& block : groups_.back().blocks)
        between_.back().push_back(between(block, groups_.back().own, of.stress));
    }
  }

  void apply(std::span<const double> x, std::span<double> y) override {
    space_.fill(x, {});
    space_.clear_forces();
    const finite::Values<D> at{space_.nodes(), space_.points(), space_.forces(), space_.point_forces(),
                               nullptr};
    for (std::size_t g = 0; g < groups_.size(); ++g)
      for (std::size_t i = 0; i < groups_[g].blocks.size(); ++i)
        push(groups_[g].blocks[i], between_[g][i], at);
    if (edges_) push_edges(at);
    for (const PlaceBlock& b : pressure_) {
      const double* from = space_.value(b.j);
      double* to = space_.force_at(b.i);
      for (int k = 0; k < D; ++k)
        for (int m = 0; m < D; ++m) to[k] += b.block(k, m) * from[m];
    }
    space_.collect();
    space_.take_rows({}, {}, y);
  }

 private:
  struct Between {
    double s[D][D][4];
  };

  /// S = V B sigma B^T / g^2: the rows of B are the areas along and across a face, by which its differences of u become a gradient
  /// (theory, 5i). All components of u meet the same one, so a face needs D^2 numbers in place of its geometry and stress.
  static Between between(const finite::FiniteBlock<D>& block, double own,
                         const std::vector<Tensor3>& stress) {
    Between result{};
    for (std::size_t k = 0; k < 4; ++k) {
      if (block.face[k] < 0) continue;  // filling
      Eigen::Matrix<double, D, D> b;
      for (int i = 0; i < D; ++i)
        for (int j = 0; j < D; ++j) b(i, j) = block.vector[i][j][k];
      const Eigen::Matrix<double, D, D> s =
          own * block.weight[k] * block.inverse[k] *
          (b * stress[std::size_t(block.face[k])].template topLeftCorner<D, D>() * b.transpose());
      for (int i = 0; i < D; ++i)
        for (int j = 0; j < D; ++j) result.s[i][j][k] = s(i, j);
    }
    return result;
  }

  static void push(const finite::FiniteBlock<D>& block, const Between& between, const finite::Values<D>& at) {
    Four u[D][D];
    blocks::differences<D>(block, at.nodes, at.points, u);
    for (int i = 0; i < D; ++i) {
      Four force[D] = {};
      for (int j = 0; j < D; ++j)
        for (int a = 0; a < D; ++a) force[a] += blocks::wide(between.s[i][j]) * u[j][a];
      blocks::pull<D>(block, i, force, at.forces, at.point_forces);
    }
  }

  /// Mean gradients of the edges, times the stress there.
  void push_edges(const finite::Values<D>& at) {
    std::ranges::fill(edge_value_, 0);
    for (const finite::Group<D>& group : groups_) finite::to_edges<D>(group, at, true, edge_value_.data());
    edges_->finish_gradients(edge_value_);
    for (std::size_t e = 0; e < edge_stress_.size(); ++e) {
      Eigen::Map<Eigen::Matrix<double, 3, 3, Eigen::RowMajor>> g(edge_value_.data() +
                                                                 e * SharedEdges::gradient_stride);
      g = (g * edge_stress_[e]).eval();
    }
    for (const finite::Group<D>& group : groups_) finite::from_edges<D>(group, at, edge_value_.data());
  }

  SymmetricSpace<D> space_;
  std::vector<finite::Group<D>> groups_;
  std::vector<std::vector<Between>> between_;  // of each group, one a block
  std::unique_ptr<SharedEdges> edges_;
  std::vector<Tensor3> edge_stress_;
  std::vector<double> edge_value_;
  std::vector<PlaceBlock> pressure_;
};

}  // namespace

std::unique_ptr<StressStiffness> make_stress_stiffness(const mesh::Mesh& mesh, const ElasticOperator& rows,
                                                       Prestress of) {
  if (mesh.dim == 2) return std::make_unique<StressStiffnessOf<2>>(mesh, rows, std::move(of));
  return std::make_unique<StressStiffnessOf<3>>(mesh, rows, std::move(of));
}

}  // namespace couplet::elastic
