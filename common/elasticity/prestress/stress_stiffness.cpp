// SPDX-License-Identifier: Apache-2.0
#include "common/elasticity/prestress/stress_stiffness.hpp"

#include <algorithm>
#include <utility>

#include "common/elasticity/symmetric/shared_edges.hpp"
#include "common/elasticity/symmetric/shared_faces.hpp"
#include "common/elasticity/symmetric/symmetric_space.hpp"
#include "common/parallel/collective.hpp"

namespace couplet::elastic {
namespace {

template <int D>
class StressStiffnessOf final : public StressStiffness {
  static constexpr int stride = SymmetricSpace<D>::stride;
  static constexpr int edge_stride = SharedEdges::gradient_stride;
  using Matrix = Eigen::Matrix<double, D, D>;

 public:
  StressStiffnessOf(const mesh::Mesh& mesh, const ElasticOperator& rows, Prestress of)
      : mesh_(mesh), space_(mesh, rows), pressure_(std::move(of.pressure)) {
    for (Index f = 0; f < mesh.n_flux_faces(); ++f) {
      if (mesh.owner[f] >= mesh.cells.n_owned()) continue;
      faces_.push_back({f, space_.node_across(f), symmetric_face<D>(mesh, rows, f), -1,
                        of.stress[std::size_t(f)].template topLeftCorner<D, D>()});
    }
    make_edges(rows, of.stress);
    for (const Face& face : faces_) between_.push_back(between(face));
  }

  void apply(std::span<const double> x, std::span<double> y) override {
    space_.fill(x, {});
    space_.clear_forces();
    if (edges_) find_means();
    for (std::size_t f = 0; f < faces_.size(); ++f) {
      push(faces_[f], between_[f]);
      if (faces_[f].shared >= 0) push_edges(faces_[f]);
    }
    for (const PlaceBlock& b : pressure_) {
      const double* from = at(b.j, space_.nodes(), space_.points());
      double* to = const_cast<double*>(at(b.i, space_.forces(), space_.point_forces()));
      for (int k = 0; k < D; ++k)
        for (int m = 0; m < D; ++m) to[k] += b.block(k, m) * from[m];
    }
    space_.collect();
    space_.take_rows({}, {}, y);
  }

 private:
  struct Face {
    Index face, across;
    SymmetricFace<D> geometry;
    Index shared;  // place in edges_of(); -1: shares nothing
    Matrix stress;
  };

  const double* at(Index place, const double* nodes, const double* points) const {
    const auto n = Index(space_.n_nodes());
    return place < n ? nodes + std::size_t(place) * stride : points + std::size_t(place - n) * stride;
  }

  void make_edges(const ElasticOperator& rows, const std::vector<Tensor3>& stress) {
    const SharedFaces shared = shared_faces(mesh_, rows);
    if (!parallel::any(mesh_.comm, shared.n_mine > 0)) return;
    edges_ = std::make_unique<SharedEdges>(mesh_, rows, shared.faces, shared.volume);
    find_edge_stresses(shared, stress, *edges_);
    for (Index e = 0; e < Index(edges_->n_edges()); ++e)
      edge_stress_.push_back(edge_tensor(*edges_, e).template topLeftCorner<D, D>());
    edge_value_.resize(edges_->n_edges() * edge_stride);
    std::size_t next = 0;
    for (Face& face : faces_)
      if (next < shared.n_mine && shared.faces[next] == face.face) face.shared = Index(next++);
  }

  /// S = V B sigma B^T / g^2: the rows of B are the areas along and across a face, by which its differences of u become a gradient
  /// (theory, 5i). All components of u meet the same one, so a face needs D^2 numbers in place of its geometry and stress.
  Matrix between(const Face& face) const {
    const SymmetricFace<D>& g = face.geometry;
    Matrix b;
    for (int j = 0; j < D; ++j) {
      b(0, j) = g.area[j];
      for (int i = 0; i < D - 1; ++i) b(1 + i, j) = g.across[i][j];
    }
    const double share = face.shared < 0 ? 1 : 1 - SharedEdges::share;
    return share * g.volume * g.inverse * g.inverse * (b * face.stress * b.transpose());
  }

  /// Entry (k, j) = d u_k / d x_j.
  Matrix gradient(const Face& face) const {
    const SymmetricFace<D>& g = face.geometry;
    const double *here = space_.nodes() + std::size_t(mesh_.owner[face.face]) * stride,
                 *there = space_.nodes() + std::size_t(face.across) * stride;
    Matrix h;
    for (int k = 0; k < D; ++k)
      for (int j = 0; j < D; ++j) {
        double v = (there[k] - here[k]) * g.area[j];
        for (int i = 0; i < D - 1; ++i)
          v += (space_.points()[std::size_t(g.plus[i]) * stride + k] -
                space_.points()[std::size_t(g.minus[i]) * stride + k]) *
               g.across[i][j];
        h(k, j) = v * g.inverse;
      }
    return h;
  }

  /// Mean gradients of the edges, times the stress there.
  void find_means() {
    std::ranges::fill(edge_value_, 0);
    for (const Face& face : faces_) {
      if (face.shared < 0) continue;
      const Matrix h = SharedEdges::share * face.geometry.volume / 3 * gradient(face);
      for (const Index e : edges_->edges_of(std::size_t(face.shared)))
        for (int k = 0; k < D; ++k)
          for (int j = 0; j < D; ++j)
            edge_value_[std::size_t(e) * edge_stride + std::size_t(k * 3 + j)] += h(k, j);
    }
    edges_->finish_gradients(edge_value_);
    for (std::size_t e = 0; e < edge_stress_.size(); ++e) {
      Eigen::Map<Eigen::Matrix<double, 3, 3, Eigen::RowMajor>> g(edge_value_.data() + e * edge_stride);
      g.template topLeftCorner<D, D>() = (g.template topLeftCorner<D, D>() * edge_stress_[e]).eval();
    }
  }

  void push(const Face& face, const Matrix& s) {
    const SymmetricFace<D>& g = face.geometry;
    const double *from = space_.nodes() + std::size_t(mesh_.owner[face.face]) * stride,
                 *to = space_.nodes() + std::size_t(face.across) * stride;
    double *here = space_.forces() + std::size_t(mesh_.owner[face.face]) * stride,
           *there = space_.forces() + std::size_t(face.across) * stride;
    for (int k = 0; k < D; ++k) {
      double difference[D];
      difference[0] = to[k] - from[k];
      for (int i = 0; i < D - 1; ++i)
        difference[1 + i] = space_.points()[std::size_t(g.plus[i]) * stride + k] -
                            space_.points()[std::size_t(g.minus[i]) * stride + k];
      double force[D] = {};
      for (int i = 0; i < D; ++i)
        for (int j = 0; j < D; ++j) force[i] += s(i, j) * difference[j];
      here[k] -= force[0];
      there[k] += force[0];
      for (int i = 0; i < D - 1; ++i) {
        space_.point_forces()[std::size_t(g.plus[i]) * stride + k] += force[1 + i];
        space_.point_forces()[std::size_t(g.minus[i]) * stride + k] -= force[1 + i];
      }
    }
  }

  /// What the stress of its edges adds, from their mean gradients.
  void push_edges(const Face& face) {
    const SymmetricFace<D>& g = face.geometry;
    Matrix p = Matrix::Zero();
    for (const Index e : edges_->edges_of(std::size_t(face.shared)))
      p += SharedEdges::share * g.volume * g.inverse / 3 *
           Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(edge_value_.data() +
                                                                          std::size_t(e) * edge_stride)
               .template topLeftCorner<D, D>();
    double *here = space_.forces() + std::size_t(mesh_.owner[face.face]) * stride,
           *there = space_.forces() + std::size_t(face.across) * stride;
    for (int k = 0; k < D; ++k) {
      double along = 0;
      for (int j = 0; j < D; ++j) along += p(k, j) * g.area[j];
      here[k] -= along;
      there[k] += along;
      for (int i = 0; i < D - 1; ++i) {
        double across = 0;
        for (int j = 0; j < D; ++j) across += p(k, j) * g.across[i][j];
        space_.point_forces()[std::size_t(g.plus[i]) * stride + k] += across;
        space_.point_forces()[std::size_t(g.minus[i]) * stride + k] -= across;
      }
    }
  }

  const mesh::Mesh& mesh_;
  SymmetricSpace<D> space_;
  std::vector<Face> faces_;
  std::vector<Matrix> between_;
  std::unique_ptr<SharedEdges> edges_;
  std::vector<Matrix> edge_stress_;
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
