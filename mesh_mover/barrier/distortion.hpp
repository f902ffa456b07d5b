// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>

namespace couplet::mesh_mover {

/// The symmetric Dirichlet energy [smith2015] of a simplex with the deformation gradient F,
///   W = |F|^2 + |F^-1|^2 - 2 D = sum_i (s_i^2 + s_i^-2 - 2),   s_i the stretches:
/// zero for rigid motions alone, infinite where det F -> 0; a cell that is compressed to a share s costs what one that
/// is stretched by 1/s does.
template <int D>
struct Distortion {
  using Matrix = Eigen::Matrix<double, D, D>;
  static constexpr double unbounded = 1e300;

  static double energy(const Matrix& f) { return f.squaredNorm() + f.inverse().squaredNorm() - 2 * D; }

  /// dW/dF = 2 F - 2 F^-T F^-1 F^-T.
  static Matrix stress(const Matrix& f) {
    const Matrix inverse = f.inverse();
    return 2 * f - 2 * (inverse * inverse.transpose() * inverse).transpose();
  }

  /// d2W/dF2 in the frame of the stretches, F = U diag(s) V^T [smith2019]: of the (ij) entry with itself `own`,
  /// with the (ji) entry `across`. W is a sum over the stretches, so the stretches have W''(s_i) = 2 + 6 s_i^-4; each
  /// pair of them a symmetric mode (W'_i - W'_j) / (s_i - s_j) and an antisymmetric one (W'_i + W'_j) / (s_i + s_j),
  /// which alone may be negative: `is_projected` without that.
  struct Tangent {
    Matrix u, v;
    Matrix own, across;
  };
  static Tangent tangent(const Matrix& f, bool is_projected) {
    const Eigen::SelfAdjointEigenSolver<Matrix> eigen = decompose(f.transpose() * f);
    Tangent t;
    t.v = eigen.eigenvectors();
    t.u = f * t.v;
    std::array<double, D> s;
    for (int i = 0; i < D; ++i) {
      s[i] = t.u.col(i).norm();
      t.u.col(i) /= s[i];
      t.own(i, i) = 2 + 6 / (s[i] * s[i] * s[i] * s[i]);
      t.across(i, i) = 0;
    }
    for (int i = 0; i < D; ++i)
      for (int j = 0; j < i; ++j) {
        const double product = s[i] * s[j], cube = product * product * product;
        const double squares = s[i] * s[i] + s[j] * s[j];
        const double even = 2 + 2 * (squares + product) / cube;
        const double odd = std::max(2 - 2 * (squares - product) / cube, is_projected ? 0.0 : -unbounded);
        t.own(i, j) = t.own(j, i) = (even + odd) / 2;
        t.across(i, j) = t.across(j, i) = (even - odd) / 2;
      }
    return t;
  }

 private:
  static Eigen::SelfAdjointEigenSolver<Matrix> decompose(const Matrix& c) {
    Eigen::SelfAdjointEigenSolver<Matrix> eigen;
    eigen.computeDirect(c);
    return eigen;
  }
};

}  // namespace couplet::mesh_mover
