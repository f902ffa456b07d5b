// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>

#include "common/base/types.hpp"

namespace couplet::fv {

/// How the weights of a point's nodes are found, thesis (2.48)-(2.51), see VertexInterpolation:
///   w_i = (1 + lambda . r_i) / d_i,   r_i = (x_V - x_i) / d_i,   sum_i r_i r_i^T lambda = - sum_i r_i
/// `least_squares`: lambda . r_i d_i in place of lambda . r_i. All sums are over the nodes, so that they may be taken in parts
/// (over ranks, or over the copies of a point on periodic patches).
enum class VertexWeights { inverse_distance, least_squares };

/// The sums that lambda follows from.
struct VertexSums {
  Tensor3 m = Tensor3::Zero();
  Vec3 s = Vec3::Zero();
  double inverse_distance = 0, count = 0;

  /// `from`: x_V - x_i [m]; only the part of its direction in `within` counts.
  void add(const Vec3& from, VertexWeights kind, const Tensor3* within) {
    const double d = from.norm();
    inverse_distance += 1 / d;
    count += 1;
    Vec3 r = from / d;
    if (within) r = *within * r;
    m += (kind == VertexWeights::least_squares ? d : 1) * r * r.transpose();
    s += r;
  }
  /// Least-norm solution, within `within`.
  Vec3 lambda(int dim, const Tensor3* within) const;
};

/// What the weights, not yet of sum 1, make together.
struct VertexWeightSums {
  double sum = 0, squares = 0;
  Vec3 miss = Vec3::Zero();  ///< weighted mean of the x_V - x_i, times the sum

  void add(double weight, const Vec3& from) {
    sum += weight;
    squares += weight * weight;
    miss += weight * from;
  }
  /// The weights cancel: no weighted mean of the nodes reaches the point, and the plain inverse distance serves.
  bool cancels(const VertexSums& nodes) const;
  /// The weighted mean of the nodes is the point: linear fields are met.
  bool meets(const VertexSums& nodes, const Tensor3* within) const;
};

inline double vertex_weight(const Vec3& from, const Vec3& lambda, VertexWeights kind) {
  const double d = from.norm();
  return (1 + lambda.dot(from) / (kind == VertexWeights::least_squares ? 1 : d)) / d;
}

}  // namespace couplet::fv
