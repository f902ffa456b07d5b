// SPDX-License-Identifier: Apache-2.0
#include "coupler/mapping/map_local.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

namespace couplet::coupler {
namespace {

double wendland(double r) {
  const double s = (1 - r) * (1 - r);
  return r < 1 ? s * s * (4 * r + 1) : 0;
}

/// Coordinates about the sources' centre, in units of their reach, along the directions that the polynomial
/// takes: sources first, x last.
Eigen::MatrixXd coordinates(const std::vector<Vec3>& points, std::span<const Index> sources, const Vec3& x) {
  const auto n = Eigen::Index(sources.size());
  Eigen::MatrixXd at(n + 1, 3);
  for (Eigen::Index j = 0; j < n; ++j) at.row(j) = points[sources[j]];
  at.row(n) = x;
  const Eigen::RowVector3d centre = at.topRows(n).colwise().mean();
  at.rowwise() -= centre;
  const Eigen::Matrix3d spread = at.topRows(n).transpose() * at.topRows(n) / double(n);
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(spread);
  const double widest = std::sqrt(std::max(0., solver.eigenvalues()[2]));
  if (widest == 0) return Eigen::MatrixXd(n + 1, 0);
  const Eigen::MatrixXd along = at * solver.eigenvectors() / widest;
  std::vector<Eigen::Index> kept;
  for (Eigen::Index d = 2; d >= 0; --d) {
    const double low = along.col(d).head(n).minCoeff(), high = along.col(d).head(n).maxCoeff();
    // A spread of a thousandth is a direction of its own (a curved surface) only for an x between the
    // sources.
    const bool thin = high - low < 0.3;
    const double slack = (thin ? 0.5 : 10) * (high - low), here = along(n, d);
    if (high - low > 1e-6 && here > low - slack && here < high + slack) kept.push_back(d);
  }
  Eigen::MatrixXd result(n + 1, Eigen::Index(kept.size()));
  for (std::size_t d = 0; d < kept.size(); ++d) result.col(Eigen::Index(d)) = along.col(kept[d]);
  return result;
}

}  // namespace

std::vector<double> local_weights(const std::vector<Vec3>& points, std::span<const Index> sources,
                                  const Vec3& x) {
  const auto n = Eigen::Index(sources.size());
  if (n == 1) return {1.};
  double reach = 0;
  for (const Index i : sources)
    for (const Index j : sources) reach = std::max(reach, (points[i] - points[j]).norm());
  reach *= 1.5;
  if (reach == 0) return std::vector<double>(sources.size(), 1. / double(n));
  const Eigen::MatrixXd at = coordinates(points, sources, x);
  const Eigen::Index m = n + 1 + at.cols();
  Eigen::MatrixXd a = Eigen::MatrixXd::Zero(m, m);
  Eigen::VectorXd b(m);
  for (Eigen::Index i = 0; i < n; ++i) {
    for (Eigen::Index j = 0; j < n; ++j)
      a(i, j) = wendland((points[sources[i]] - points[sources[j]]).norm() / reach);
    b[i] = wendland((points[sources[i]] - x).norm() / reach);
  }
  a.block(0, n, n, 1).setOnes();
  a.block(0, n + 1, n, at.cols()) = at.topRows(n);
  a.bottomLeftCorner(m - n, n) = a.topRightCorner(n, m - n).transpose();
  b[n] = 1;
  b.tail(at.cols()) = at.row(n).transpose();
  Eigen::VectorXd w = a.partialPivLu().solve(b);
  // Sources on top of each other or too few of them for the polynomial: the smallest weights that do.
  if (!w.allFinite() || (a * w - b).norm() > 1e-11 * b.norm())
    w = a.completeOrthogonalDecomposition().solve(b);
  return {w.data(), w.data() + n};
}

}  // namespace couplet::coupler
