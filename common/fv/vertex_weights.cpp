// SPDX-License-Identifier: Apache-2.0
#include "common/fv/vertex_weights.hpp"

#include <Eigen/Dense>

namespace couplet::fv {
namespace {

// Directions the nodes do not span: eigenvalues of sum r r^T below this part of the largest (r are unit
// vectors, so that a cell of aspect ratio 1e5 still counts as spanning).
constexpr double spanned = 1e-12;
// No weighted mean of the nodes reaches the point: the weights cancel to this part of sum 1/d.
constexpr double reachable = 1e-8;
// The weighted mean of the nodes misses the point by this part of their distance: linear fields are not
// exact.
constexpr double exact = 1e-6;

/// Least-norm solution of M lambda = -s.
Vec3 solve_lambda(const Tensor3& m, const Vec3& s, int dim) {
  if (dim == 2) {
    const double det = m(0, 0) * m(1, 1) - m(0, 1) * m(1, 0), trace = m(0, 0) + m(1, 1);
    if (det > 1e-9 * trace * trace)
      return {-(m(1, 1) * s[0] - m(0, 1) * s[1]) / det, -(m(0, 0) * s[1] - m(1, 0) * s[0]) / det, 0};
  } else {
    const double trace = m.trace();
    if (m.determinant() > 1e-9 * trace * trace * trace) return -(m.inverse() * s);
  }
  const Eigen::SelfAdjointEigenSolver<Tensor3> eigen(m);
  Vec3 lambda = Vec3::Zero();
  for (int i = 0; i < 3; ++i) {
    if (eigen.eigenvalues()[i] <= spanned * eigen.eigenvalues()[2]) continue;
    const Vec3 v = eigen.eigenvectors().col(i);
    lambda -= v * (v.dot(s) / eigen.eigenvalues()[i]);
  }
  return lambda;
}

}  // namespace

Vec3 VertexSums::lambda(int dim, const Tensor3* within) const {
  if (!within) return solve_lambda(m, s, dim);
  // Across symmetry planes M is filled up with a diagonal: s has no part there, so lambda gets none.
  return solve_lambda(m + 0.5 * m.trace() * (Tensor3::Identity() - *within), s, dim);
}

bool VertexWeightSums::cancels(const VertexSums& nodes) const {
  return std::abs(sum) < reachable * nodes.inverse_distance;
}

bool VertexWeightSums::meets(const VertexSums& nodes, const Tensor3* within) const {
  // inverse_distance / count is one over the distance of the nodes.
  const double off = within ? (*within * miss).norm() : miss.norm();
  return off * nodes.inverse_distance <= exact * nodes.count * std::abs(sum);
}

}  // namespace couplet::fv
