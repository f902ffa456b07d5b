// SPDX-License-Identifier: Apache-2.0
#include "coupler/growing_qr.hpp"

#include <Eigen/Dense>
#include <cmath>

#include "common/io/checkpoint.hpp"
#include "coupler/accelerator.hpp"

namespace couplet {
namespace {

/// Rows i and i+1 of R and the columns of Q that belong to them: R_{i+1,column} becomes zero, Q R stays.
void rotate(Eigen::MatrixXd& r, std::vector<std::vector<double>>& q, int i, int column) {
  const double a = r(i, column), b = r(i + 1, column);
  if (b == 0) return;
  const double length = std::hypot(a, b), c = a / length, s = b / length;
  for (int j = 0; j < r.cols(); ++j) {
    const double up = r(i, j), down = r(i + 1, j);
    r(i, j) = c * up + s * down;
    r(i + 1, j) = -s * up + c * down;
  }
  r(i + 1, column) = 0;
  for (std::size_t k = 0; k < q[i].size(); ++k) {
    const double up = q[i][k], down = q[i + 1][k];
    q[i][k] = c * up + s * down;
    q[i + 1][k] = -s * up + c * down;
  }
}

}  // namespace

Eigen::VectorXd GrowingQr::along(std::span<const double> r) const {
  Eigen::VectorXd t(columns());
  for (int j = 0; j < columns(); ++j) t[j] = dot(q_[j], r);
  sum_over(comm_, {t.data(), std::size_t(t.size())});
  return t;
}

void GrowingQr::subtract(const Eigen::VectorXd& t, std::span<double> r) const {
  for (int j = 0; j < columns(); ++j)
    for (std::size_t k = 0; k < r.size(); ++k) r[k] -= t[j] * q_[j][k];
}

void GrowingQr::push_front(std::vector<double> v) {
  double norms[2] = {dot(v, v), 0};
  const int m = columns();
  Eigen::VectorXd a = Eigen::VectorXd::Zero(m + 1);
  for (int sweep = 0; sweep < 2; ++sweep) {
    const Eigen::VectorXd t = along(v);
    subtract(t, v);
    a.head(m) += t;
  }
  norms[1] = dot(v, v);
  sum_over(comm_, norms);
  // What rounding leaves of a dependent column has no direction: it becomes a zero column of Q.
  const double rest = std::sqrt(norms[1]);
  const bool dependent = rest <= 1e-14 * std::sqrt(norms[0]);
  a[m] = dependent ? 0 : rest;
  for (double& entry : v) entry = dependent ? 0 : entry / rest;

  Eigen::MatrixXd grown = Eigen::MatrixXd::Zero(m + 1, m + 1);
  grown.col(0) = a;
  grown.topRightCorner(m, m) = r_;
  r_ = std::move(grown);
  q_.push_back(std::move(v));
  for (int i = m - 1; i >= 0; --i) rotate(r_, q_, i, 0);
}

void GrowingQr::erase(int column) {
  const int m = columns();
  Eigen::MatrixXd shrunk(m, m - 1);
  shrunk.leftCols(column) = r_.leftCols(column);
  shrunk.rightCols(m - 1 - column) = r_.rightCols(m - 1 - column);
  for (int i = column; i < m - 1; ++i) rotate(shrunk, q_, i, i);
  r_ = shrunk.topRows(m - 1);
  q_.pop_back();
}

void GrowingQr::clear() {
  q_.clear();
  r_.resize(0, 0);
}

std::vector<int> GrowingQr::drop(double limit) {
  std::vector<int> dropped;
  for (int j = 0; j < columns();) {
    const double norm = r_.col(j).norm();
    if (norm > 0 && std::abs(r_(j, j)) >= std::max(limit, 1e-14) * norm) {
      ++j;
      continue;
    }
    erase(j);
    dropped.push_back(j);
  }
  return dropped;
}

Eigen::VectorXd GrowingQr::back_substitute(const Eigen::VectorXd& t) const {
  return r_.triangularView<Eigen::Upper>().solve(t);
}

Eigen::VectorXd GrowingQr::minimise(std::span<const double> r) const { return -back_substitute(along(r)); }

void GrowingQr::save(CheckpointWriter& file, const std::string& name) const {
  std::vector<double> q;
  for (const auto& column : q_) q.insert(q.end(), column.begin(), column.end());
  file.write_scalar(name + ".columns", columns());
  file.write(name + ".q", q);
  file.write(name + ".r", {r_.data(), std::size_t(r_.size())});
}

void GrowingQr::load(CheckpointReader& file, const std::string& name, std::size_t rows) {
  const int m = static_cast<int>(file.read_scalar(name + ".columns"));
  std::vector<double> q(m * rows), r(std::size_t(m) * m);
  file.read(name + ".q", q);
  file.read(name + ".r", r);
  q_.clear();
  for (int j = 0; j < m; ++j) q_.emplace_back(q.begin() + j * rows, q.begin() + (j + 1) * rows);
  r_ = Eigen::Map<Eigen::MatrixXd>(r.data(), m, m);
}

}  // namespace couplet
