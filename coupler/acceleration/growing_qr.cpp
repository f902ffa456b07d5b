// SPDX-License-Identifier: Apache-2.0
#include "coupler/acceleration/growing_qr.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "common/io/checkpoint.hpp"
#include "coupler/acceleration/accelerator.hpp"

namespace couplet::coupler {
namespace {

/// Rotates rows `row` and `row` + 1 of R and the corresponding columns of Q.
struct Rotation {
  int row;
  double c, s;
};

/// Eliminates R_{i+1,column}; Q must be rotated accordingly.
void rotate(Eigen::MatrixXd& r, int i, int column, std::vector<Rotation>& turns) {
  const double a = r(i, column), b = r(i + 1, column);
  if (b == 0) return;
  const double length = std::hypot(a, b), c = a / length, s = b / length;
  for (int j = 0; j < r.cols(); ++j) {
    const double up = r(i, j), down = r(i + 1, j);
    r(i, j) = c * up + s * down;
    r(i + 1, j) = -s * up + c * down;
  }
  r(i + 1, column) = 0;
  turns.push_back({i, c, s});
}

void turn(std::vector<std::vector<double>>& q, const std::vector<Rotation>& turns, std::size_t first,
          std::size_t count) {
  for (const Rotation& t : turns) {
    double *up = q[std::size_t(t.row)].data() + first, *down = q[std::size_t(t.row) + 1].data() + first;
    for (std::size_t k = 0; k < count; ++k) {
      const double u = up[k], d = down[k];
      up[k] = t.c * u + t.s * d;
      down[k] = -t.s * u + t.c * d;
    }
  }
}

/// v -= t q.
void take_away(double t, const double* q, double* v, std::size_t count) {
  for (std::size_t k = 0; k < count; ++k) v[k] -= t * q[k];
}

}  // namespace

void GrowingQr::push_front(std::vector<double> v) {
  const int m = columns();
  // First sweep: t = Q^T v. Its last entry |v|^2 is the scale of round-off.
  Eigen::VectorXd t = Eigen::VectorXd::Zero(m + 1), again = t;
  for_blocks(v.size(), [&](std::size_t first, std::size_t count) {
    const std::span<const double> here(v.data() + first, count);
    for (int j = 0; j < m; ++j) t[j] += dot({q_[std::size_t(j)].data() + first, count}, here);
    t[m] += dot(here, here);
  });
  sum_over(comm_, {t.data(), std::size_t(m) + 1});
  // Second sweep for v - Q t, with its squared norm last.
  for_blocks(v.size(), [&](std::size_t first, std::size_t count) {
    double* here = v.data() + first;
    for (int j = 0; j < m; ++j) take_away(t[j], q_[std::size_t(j)].data() + first, here, count);
    for (int j = 0; j < m; ++j) again[j] += dot({q_[std::size_t(j)].data() + first, count}, {here, count});
    again[m] += dot({here, count}, {here, count});
  });
  sum_over(comm_, {again.data(), std::size_t(m) + 1});
  // The remainder is |v - Q t - Q t'|^2 = |v - Q t|^2 - |t'|^2 with small t'. Round-off of a dependent column
  // has no direction, so it becomes a zero column of Q.
  const double rest = std::sqrt(std::max(0., again[m] - again.head(m).squaredNorm()));
  const bool dependent = rest <= 1e-14 * std::sqrt(t[m]);

  Eigen::MatrixXd grown = Eigen::MatrixXd::Zero(m + 1, m + 1);
  grown.col(0).head(m) = t.head(m) + again.head(m);
  grown(m, 0) = dependent ? 0 : rest;
  grown.topRightCorner(m, m) = r_;
  r_ = std::move(grown);
  q_.push_back(std::move(v));
  std::vector<Rotation> turns;
  for (int i = m - 1; i >= 0; --i) rotate(r_, i, 0, turns);
  for_blocks(q_.back().size(), [&](std::size_t first, std::size_t count) {
    double* here = q_.back().data() + first;
    for (int j = 0; j < m; ++j) take_away(again[j], q_[std::size_t(j)].data() + first, here, count);
    for (std::size_t k = 0; k < count; ++k) here[k] = dependent ? 0 : here[k] / rest;
    turn(q_, turns, first, count);
  });
}

void GrowingQr::erase(int column) {
  const int m = columns();
  Eigen::MatrixXd shrunk(m, m - 1);
  shrunk.leftCols(column) = r_.leftCols(column);
  shrunk.rightCols(m - 1 - column) = r_.rightCols(m - 1 - column);
  std::vector<Rotation> turns;
  for (int i = column; i < m - 1; ++i) rotate(shrunk, i, i, turns);
  if (!turns.empty())
    for_blocks(q_.front().size(),
               [&](std::size_t first, std::size_t count) { turn(q_, turns, first, count); });
  r_ = shrunk.topRows(m - 1);
  q_.pop_back();
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

Eigen::VectorXd GrowingQr::minimise(std::span<const double> r) const {
  Eigen::VectorXd t = Eigen::VectorXd::Zero(columns());  // Q^T r
  for_blocks(r.size(), [&](std::size_t first, std::size_t count) {
    for (int j = 0; j < columns(); ++j)
      t[j] += dot({q_[std::size_t(j)].data() + first, count}, r.subspan(first, count));
  });
  sum_over(comm_, {t.data(), std::size_t(t.size())});
  return -r_.triangularView<Eigen::Upper>().solve(t);
}

void GrowingQr::save(io::CheckpointWriter& file, const std::string& name,
                     const parallel::GlobalOrder& order) const {
  file.write_scalar(name + ".columns", columns());
  write_columns(file, order, name + ".q", {q_.begin(), q_.end()});
  file.write_common(name + ".r", {r_.data(), std::size_t(r_.size())});
}

void GrowingQr::load(io::CheckpointReader& file, const std::string& name,
                     const parallel::GlobalOrder& order) {
  const std::size_t m = file.read_count(name + ".columns", most_columns);
  std::vector<double> r(m * m);
  q_ = read_columns(file, order, name + ".q", m);
  file.read_common(name + ".r", r);
  r_ = Eigen::Map<Eigen::MatrixXd>(r.data(), Eigen::Index(m), Eigen::Index(m));
}

}  // namespace couplet::coupler
