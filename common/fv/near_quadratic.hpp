// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <span>

#include "common/base/types.hpp"

namespace couplet::fv {

/// Least squares of quadratics around a centre, phi = 1, x_a, x_a x_b (a <= b), x = (place - centre) / reach, for the value there: near samples
/// count more, by 1 / (0.05 + x^2). Terms that the samples do not determine become small, those of a direction that they do not
/// span zero.
class NearQuadratic {
 public:
  /// `reach` [m]: the largest distance of a sample; `values` a sample.
  NearQuadratic(int dim, const Vec3& centre, double reach, int values);
  void add(const Vec3& place, std::span<const double> values);
  /// Row i: what the term i of each value counts.
  Eigen::MatrixXd solve() const;
  Eigen::VectorXd terms(const Vec3& place) const;

 private:
  int dim_;
  Vec3 centre_;
  double reach_;
  Eigen::MatrixXd of_, right_;
};

}  // namespace couplet::fv
