// SPDX-License-Identifier: Apache-2.0
#include "common/elasticity/thesis/least_squares.hpp"

#include <algorithm>

namespace couplet::elastic {

void LeastSquares::apply(std::span<const double> unknowns, std::span<const double> known,
                         std::span<double> result) {
  if (!matrix_) matrix_.emplace(rows_.matrix({}));
  matrix_->multiply(unknowns, result);
  if (known.empty()) return;
  std::vector<double> opposite(known.begin(), known.end());
  for (double& value : opposite) value = -value;
  rows_.subtract_known(opposite, result);
}

template <int D>
void LeastSquares::find_points(std::span<const double> unknowns, std::span<const double> known) {
  nodes_.fill<D>(unknowns, known);
  for (const Index v : vertices_.free) {
    const auto node = rows_.vertices().nodes(v);
    const auto weight = rows_.vertices().weights(v);
    Vec<D> u = Vec<D>::Zero();
    for (std::size_t i = 0; i < node.size(); ++i) u += weight[i] * Eigen::Map<const Vec<D>>(nodes_[node[i]]);
    std::copy_n(u.data(), D, points_.data() + std::size_t(v) * D);
  }
  vertices_.constrain<D>(points_, D, known);
}

/// The node across a symmetry plane is the mirror image of the owner, which leaves only the normal part.
template <int D>
Tensor3 LeastSquares::gradient(Index f) const {
  using Values = Eigen::Map<const Vec<D>>;
  const Tensor<D> tangential = gradient_.tangential_gradient<D>(mesh_, f, points_);
  const Vec<D> here = Values(nodes_[mesh_.owner[f]]), n = gradient_.normal[f].template head<D>(),
               skew = gradient_.skew[f].template head<D>();
  Vec<D> difference = -here;
  if (f < mesh_.n_interior)
    difference += Values(nodes_[mesh_.neighbour[f]]);
  else if (!rows_.mirrored(f))
    difference += Values(nodes_.of_face(f));
  Vec<D> across = gradient_.inverse_dn[f] * difference + tangential.transpose() * skew;
  if (rows_.mirrored(f)) across = (n.dot(across) * n).eval();
  Tensor3 result = Tensor3::Zero();
  result.topLeftCorner<D, D>() = tangential + n * across.transpose();
  return result;
}

void LeastSquares::face_gradients(std::span<const double> unknowns, std::span<const double> known,
                                  const std::function<void(Index, const Tensor3&)>& take, Index first,
                                  Index end) {
  mesh_.dim == 2 ? find_points<2>(unknowns, known) : find_points<3>(unknowns, known);
  for (Index f = first; f < end; ++f) take(f, mesh_.dim == 2 ? gradient<2>(f) : gradient<3>(f));
}

void LeastSquares::point_values(std::span<const double> unknowns, std::span<const double> known,
                                std::span<double> points) {
  mesh_.dim == 2 ? find_points<2>(unknowns, known) : find_points<3>(unknowns, known);
  const auto dim = std::size_t(mesh_.dim);
  vertices_.visit([&](Index v) {
    std::copy_n(points_.data() + std::size_t(v) * dim, dim, points.data() + std::size_t(v) * dim);
  });
}

}  // namespace couplet::elastic
