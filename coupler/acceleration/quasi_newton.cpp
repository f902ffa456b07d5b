// SPDX-License-Identifier: Apache-2.0
#include "coupler/acceleration/quasi_newton.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "common/base/error.hpp"
#include "common/io/checkpoint.hpp"
#include "coupler/acceleration/accelerator.hpp"

namespace couplet::coupler {
namespace {

// Largest number of differences; each takes as much memory as three interface vectors.
constexpr int most_columns = 100;

std::vector<double> difference(const std::vector<double>& a, const std::vector<double>& b) {
  std::vector<double> result(a.size());
  for (std::size_t i = 0; i < a.size(); ++i) result[i] = a[i] - b[i];
  return result;
}

/// y += sum of c_j x_j, in blocks of rows that stay in the cache.
template <class Column>
void add_to(std::vector<double>& y, const Eigen::VectorXd& c, Column column) {
  constexpr std::size_t block = 1024;
  for (std::size_t first = 0; first < y.size(); first += block)
    for (int j = 0; j < c.size(); ++j) {
      const std::vector<double>& x = column(j);
      for (std::size_t i = first; i < std::min(first + block, y.size()); ++i) y[i] += c[j] * x[i];
    }
}

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

QuasiNewton::QuasiNewton(const AccelerationParameters& parameters, MPI_Comm comm)
    : parameters_(parameters), comm_(comm), share_(parameters.initial_relaxation), qr_(comm) {}

void QuasiNewton::start_step() {
  // An abandoned step may be due to its history, and its own pairs have another dt.
  if (open_) forget_all();
  open_ = true;
  share_ = parameters_.initial_relaxation;
  last_.reset();
  step_ += 1;
  // Columns of the current step are not counted.
  while (!step_of_.empty() && step_ - step_of_.back() > parameters_.reused_steps) drop_oldest();
}

void QuasiNewton::learn(const Iterate& x, const Iterate& image) {
  constexpr double bad_growth = 10;
  const std::optional<Pair> before = std::exchange(last_, Pair{difference(image.unknown, x.unknown), image});
  if (before) {
    const Pair& now = *last_;
    Pair pair{difference(now.residual, before->residual),
              {difference(image.unknown, before->image.unknown),
               difference(image.dependent, before->image.dependent)}};
    std::array<double, 3> squares{dot(now.residual, now.residual), dot(before->residual, before->residual),
                                  dot(pair.residual, pair.residual)};
    sum_over(comm_, squares);
    if (uses_earlier_steps() && squares[1] > 0 && std::sqrt(squares[0] / squares[1]) > bad_growth) {
      while (uses_earlier_steps()) drop_oldest();
      ++resets_;
    }
    if (squares[2] > 0) add(std::move(pair));
  }
}

Iterate QuasiNewton::next(Iterate x, const Iterate& image) {
  learn(x, image);
  Iterate next = image;
  const bool has_pairs = columns() > 0;
  if (has_pairs) {
    const Eigen::VectorXd c = qr_.minimise(last_->residual);
    add_to(next.unknown, c,
           [&](int j) -> const std::vector<double>& { return images_[std::size_t(j)].unknown; });
    add_to(next.dependent, c,
           [&](int j) -> const std::vector<double>& { return images_[std::size_t(j)].dependent; });
  }
  if (!has_pairs || !is_finite(next)) {
    if (has_pairs) ++resets_;
    forget_all();
    next = x;
    relax(next, parameters_.initial_relaxation, image);
  }
  using Vector = Eigen::Map<const Eigen::VectorXd>;
  const auto n = Eigen::Index(x.unknown.size());
  const Vector r(last_->residual.data(), n), from(x.unknown.data(), n), to(next.unknown.data(), n);
  std::array<double, 2> sums{(to - from).dot(r), r.squaredNorm()};
  sum_over(comm_, sums);
  share_ = sums[1] > 0 ? sums[0] / sums[1] : 0;
  return next;
}

void QuasiNewton::accept(const Iterate& x, const Iterate& image) {
  learn(x, image);
  open_ = false;
}

bool QuasiNewton::is_finite(const Iterate& x) const {
  // Zero times NaN or infinity is NaN, and so is any sum with it. Uses four partial sums.
  double sums[4] = {}, wrong = 0;
  for (std::size_t i = 0; i + 4 <= x.unknown.size(); i += 4)
    for (std::size_t k = 0; k < 4; ++k) sums[k] += 0 * x.unknown[i + k];
  for (std::size_t i = x.unknown.size() / 4 * 4; i < x.unknown.size(); ++i) sums[0] += 0 * x.unknown[i];
  wrong = sums[0] + sums[1] + sums[2] + sums[3] == 0 ? 0 : 1;
  sum_over(comm_, {&wrong, 1});
  return wrong == 0;
}

void QuasiNewton::drop_oldest() {
  qr_.erase(columns() - 1);
  images_.pop_back();
  step_of_.pop_back();
}

void QuasiNewton::forget_all() {
  while (!step_of_.empty()) drop_oldest();
}

void QuasiNewton::add(Pair pair) {
  qr_.push_front(std::move(pair.residual));
  images_.push_front(std::move(pair.image));
  step_of_.push_front(step_);
  for (const int j : qr_.drop(parameters_.filter)) {
    images_.erase(images_.begin() + j);
    step_of_.erase(step_of_.begin() + j);
  }
  while (columns() > most_columns) drop_oldest();
}

void QuasiNewton::visit(io::Archive& archive, const IterateOrder& order) {
  qr_.visit(archive, "iqn", order.unknown);
  const auto m = std::size_t(columns());
  std::vector<std::vector<double>> unknown, dependent;
  if (!archive.reads())
    for (const Iterate& image : images_)
      unknown.push_back(image.unknown), dependent.push_back(image.dependent);
  visit_columns(archive, order.unknown, "iqn.images", unknown, m);
  visit_columns(archive, order.dependent, "iqn.dependents", dependent, m);
  archive.common("iqn.step", step_, step_of_);
  if (!archive.reads()) return;
  images_.clear();
  for (std::size_t j = 0; j < m; ++j) images_.push_back({std::move(unknown[j]), std::move(dependent[j])});
  if (step_of_.size() != m)
    throw Error("The checkpoint's steps of differences ('iqn.step') are damaged. Use an earlier one.");
}

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

void GrowingQr::visit(io::Archive& archive, const std::string& name, const parallel::GlobalOrder& order) {
  std::vector<double> r(r_.data(), r_.data() + r_.size());
  archive.common(name + ".r", r);
  const auto m = static_cast<std::size_t>(std::lround(std::sqrt(double(r.size()))));
  if (r.size() != m * m) throw Error("The checkpoint's '{}.r' is damaged. Use an earlier one.", name);
  visit_columns(archive, order, name + ".q", q_, m);
  r_ = Eigen::Map<Eigen::MatrixXd>(r.data(), Eigen::Index(m), Eigen::Index(m));
}

}  // namespace couplet::coupler
