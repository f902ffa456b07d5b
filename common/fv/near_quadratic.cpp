// SPDX-License-Identifier: Apache-2.0
#include "common/fv/near_quadratic.hpp"

#include <Eigen/Cholesky>
#include <cmath>

namespace couplet::fv {
namespace {

constexpr double near_weight = 0.05;  // beside the square of the distance over the reach
constexpr double least_pivot = 1e-9;  // of a term that no sample determines, over one that they do
// Of the squares of a term in the samples: a direction that they do not span.
constexpr double not_spanned = 1e-20;

}  // namespace

NearQuadratic::NearQuadratic(int dim, const Vec3& centre, double reach, int values)
    : dim_(dim), centre_(centre), reach_(reach) {
  const Eigen::Index n = 1 + dim + dim * (dim + 1) / 2;
  of_ = Eigen::MatrixXd::Zero(n, n), right_ = Eigen::MatrixXd::Zero(n, values);
}

Eigen::VectorXd NearQuadratic::terms(const Vec3& place) const {
  const Vec3 x = (place - centre_) / reach_;
  Eigen::VectorXd phi(of_.rows());
  int i = 0;
  phi[i++] = 1;
  for (int a = 0; a < dim_; ++a) phi[i++] = x[a];
  for (int a = 0; a < dim_; ++a)
    for (int b = a; b < dim_; ++b) phi[i++] = x[a] * x[b];
  return phi;
}

void NearQuadratic::add(const Vec3& place, std::span<const double> values) {
  const Eigen::VectorXd phi = terms(place);
  const double weight = 1 / (near_weight + ((place - centre_) / reach_).squaredNorm());
  of_ += weight * phi * phi.transpose();
  right_ += weight * phi * Eigen::Map<const Eigen::RowVectorXd>(values.data(), right_.cols());
}

Eigen::MatrixXd NearQuadratic::solve() const {
  // Thin cells make terms of very different sizes.
  const double least = not_spanned * of_(0, 0);
  const Eigen::VectorXd scale =
      of_.diagonal().unaryExpr([&](double v) { return v > least ? 1 / std::sqrt(v) : 0; });
  Eigen::MatrixXd scaled = scale.asDiagonal() * of_ * scale.asDiagonal();
  scaled.diagonal().array() += least_pivot;
  return scale.asDiagonal() * scaled.llt().solve(scale.asDiagonal() * right_);
}

}  // namespace couplet::fv
