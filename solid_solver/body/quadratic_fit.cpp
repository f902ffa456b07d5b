// SPDX-License-Identifier: Apache-2.0
#include "solid_solver/body/quadratic_fit.hpp"

#include <Eigen/Cholesky>

namespace couplet::solid {
namespace {

// Over the sum of the weights; in units of the scale a well-placed sample adds some 0.1 to each.
constexpr double least_curvature = 1e-4, least_slope = 1e-12;

}  // namespace

void QuadraticFit::start(int dim, int components, const Vec3& centre, double scale) {
  dim_ = dim, centre_ = centre, scale_ = scale, weights_ = 0, coupled_ = false;
  of_samples_.setZero(n_terms(), n_terms());
  right_.setZero(n_terms(), components);
}

QuadraticFit::Terms QuadraticFit::terms(const Vec3& place, const Tensor3& moment) const {
  const Vec3 x = (place - centre_) / scale_;
  Terms phi(n_terms());
  int i = 0;
  phi[i++] = 1;
  for (int a = 0; a < dim_; ++a) phi[i++] = x[a];
  for (int a = 0; a < dim_; ++a)
    for (int b = a; b < dim_; ++b) phi[i++] = x[a] * x[b] + moment(a, b) / (scale_ * scale_);
  return phi;
}

QuadraticFit::Slopes QuadraticFit::slopes(const Vec3& place) const {
  const Vec3 x = (place - centre_) / scale_;
  Slopes slope = Slopes::Zero(n_terms(), 3);
  int i = 1;
  for (int a = 0; a < dim_; ++a) slope(i++, a) = 1;
  for (int a = 0; a < dim_; ++a)
    for (int b = a; b < dim_; ++b, ++i) slope(i, a) += x[b], slope(i, b) += x[a];
  return slope / scale_;
}

void QuadraticFit::add_sample(const Vec3& place, const Tensor3& moment, std::span<const double> values,
                              double weight) {
  const Terms phi = terms(place, moment);
  weights_ += weight;
  of_samples_.noalias() += weight * phi * phi.transpose();
  for (Eigen::Index k = 0; k < right_.cols(); ++k) right_.col(k) += weight * values[std::size_t(k)] * phi;
}

void QuadraticFit::add_row(const Row& row, double value, double weight) {
  const Eigen::Index n = row.size();
  if (!coupled_) {
    of_rows_.setZero(n, n);
    right_of_rows_.setZero(n);
    coupled_ = true;
  }
  const auto flat = row.reshaped();
  of_rows_.noalias() += weight * flat * flat.transpose();
  right_of_rows_.noalias() += weight * value * flat;
}

void QuadraticFit::solve() {
  const int n = n_terms();
  for (int i = 0; i < n; ++i)
    of_samples_(i, i) += weights_ * (i > dim_ ? least_curvature : i > 0 ? least_slope : 0);
  if (!coupled_) {
    coefficients_ = of_samples_.llt().solve(right_);
    return;
  }
  for (Eigen::Index k = 0; k < right_.cols(); ++k) {
    of_rows_.block(k * n, k * n, n, n) += of_samples_;
    right_of_rows_.segment(k * n, n) += right_.col(k);
  }
  coefficients_ = of_rows_.llt().solve(right_of_rows_).reshaped(n, right_.cols());
}

}  // namespace couplet::solid
