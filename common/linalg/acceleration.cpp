// SPDX-License-Identifier: Apache-2.0
#include "common/linalg/acceleration.hpp"

#include <Eigen/Dense>
#include <algorithm>

namespace couplet::linalg {

VectorAccelerator::VectorAccelerator(MPI_Comm comm, std::size_t n, const Acceleration& options)
    : comm_(comm), options_(options), last_step_(n) {
  if (options.type == Acceleration::Type::anderson) last_u_.resize(n);
}

void VectorAccelerator::restart() {
  steps_ = 0;
  du_.clear();
  df_.clear();
}

void VectorAccelerator::advance(std::span<double> u, std::span<const double> step) {
  ++steps_;
  if (options_.type == Acceleration::Type::anderson) return anderson(u, step);
  if (options_.type == Acceleration::Type::aitken) return aitken(u, step);
  for (std::size_t i = 0; i < u.size(); ++i) u[i] += step[i];
}

//   u <- u + r - gamma r,   gamma = r . (r - r') / |r - r'|^2        (2.70)-(2.72), sign corrected
void VectorAccelerator::aitken(std::span<double> u, std::span<const double> step) {
  double factor = 1;
  if (steps_ % options_.every == 0 && steps_ > 1) {
    double sums[2] = {0, 0};
    for (std::size_t i = 0; i < u.size(); ++i) {
      const double change = step[i] - last_step_[i];
      sums[0] += step[i] * change;
      sums[1] += change * change;
    }
    MPI_Allreduce(MPI_IN_PLACE, sums, 2, MPI_DOUBLE, MPI_SUM, comm_);
    if (sums[1] > 0) factor = 1 - sums[0] / sums[1];
  }
  for (std::size_t i = 0; i < u.size(); ++i) {
    u[i] += factor * step[i];
    last_step_[i] = step[i];
  }
}

// Uses differences dU, dF of the last m iterates and steps: u <- u + f - (dU + dF) g, where g minimizes |f -
// dF g|.
void VectorAccelerator::anderson(std::span<double> u, std::span<const double> step) {
  const std::size_t n = u.size();
  if (steps_ > 1) {
    if (std::ssize(du_) == options_.history) {
      std::rotate(du_.begin(), du_.begin() + 1, du_.end());
      std::rotate(df_.begin(), df_.begin() + 1, df_.end());
      std::shift_left(products_.begin(), products_.end(), options_.history + 1);
    } else {
      du_.emplace_back(n);
      df_.emplace_back(n);
    }
    for (std::size_t i = 0; i < n; ++i) {
      du_.back()[i] = u[i] - last_u_[i];
      df_.back()[i] = step[i] - last_step_[i];
    }
  }
  std::copy(u.begin(), u.end(), last_u_.begin());
  std::copy(step.begin(), step.end(), last_step_.begin());
  const auto m = static_cast<int>(df_.size());
  // Products of the newest difference with all of them, and of all with the step. Others are known.
  Eigen::MatrixXd sums = Eigen::MatrixXd::Zero(m, 2);
  for (int a = 0; a < m; ++a)
    for (std::size_t i = 0; i < n; ++i) {
      sums(a, 0) += df_[a][i] * df_.back()[i];
      sums(a, 1) += df_[a][i] * step[i];
    }
  MPI_Allreduce(MPI_IN_PLACE, sums.data(), static_cast<int>(sums.size()), MPI_DOUBLE, MPI_SUM, comm_);
  products_.resize(std::size_t(options_.history) * options_.history);
  Eigen::Map<Eigen::MatrixXd> products(products_.data(), options_.history, options_.history);
  if (m > 0) products.col(m - 1).head(m) = sums.col(0);
  if (m > 0) products.row(m - 1).head(m) = sums.col(0).transpose();
  const Eigen::MatrixXd gram = products.topLeftCorner(m, m);
  // The diagonal is scaled to ones. The rank of the factors excludes linearly dependent directions.
  const Eigen::VectorXd scale = gram.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
  const Eigen::MatrixXd scaled = scale.asDiagonal() * gram * scale.asDiagonal();
  Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd> solver;
  solver.setThreshold(1e-10);
  Eigen::VectorXd g = Eigen::VectorXd::Zero(m);
  if (m > 0) {
    solver.compute(scaled);
    g = scale.asDiagonal() * solver.solve(scale.asDiagonal() * sums.col(1));
  }
  for (std::size_t i = 0; i < n; ++i) u[i] += step[i];
  for (int a = 0; a < m; ++a)
    for (std::size_t i = 0; i < n; ++i) u[i] -= g[a] * (du_[a][i] + df_[a][i]);
}

}  // namespace couplet::linalg
