// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>

#include "common/io/checkpoint.hpp"
#include "coupler/acceleration/quasi_newton.hpp"

namespace couplet::coupler {
namespace {

std::vector<double> difference(const std::vector<double>& a, const std::vector<double>& b) {
  std::vector<double> result(a.size());
  for (std::size_t i = 0; i < a.size(); ++i) result[i] = a[i] - b[i];
  return result;
}

/// y += sum of c_j x_j, by rows that stay in the cache.
template <class Column>
void add_to(std::vector<double>& y, const Eigen::VectorXd& c, Column column) {
  constexpr std::size_t block = 1024;
  for (std::size_t first = 0; first < y.size(); first += block)
    for (int j = 0; j < c.size(); ++j) {
      const std::vector<double>& x = column(j);
      for (std::size_t i = first; i < std::min(first + block, y.size()); ++i) y[i] += c[j] * x[i];
    }
}

}  // namespace

void SecantPairs::push_front(std::vector<double> residual, Iterate image) {
  qr_.push_front(std::move(residual));
  images_.push_front(std::move(image));
}

void SecantPairs::erase(int column) {
  qr_.erase(column);
  images_.erase(images_.begin() + column);
}

std::vector<int> SecantPairs::drop(double limit) {
  std::vector<int> dropped = qr_.drop(limit);
  for (const int j : dropped) images_.erase(images_.begin() + j);
  return dropped;
}

void SecantPairs::add(const Eigen::VectorXd& c, Iterate& to) const {
  add_to(to.unknown, c, [&](int j) -> const std::vector<double>& { return images_[std::size_t(j)].unknown; });
  add_to(to.rider, c, [&](int j) -> const std::vector<double>& { return images_[std::size_t(j)].rider; });
}

void SecantPairs::save(io::CheckpointWriter& file, const std::string& name, const IterateOrder& order) const {
  qr_.save(file, name, order.unknown);
  Columns unknown, rider;
  for (const Iterate& image : images_) unknown.emplace_back(image.unknown), rider.emplace_back(image.rider);
  write_columns(file, order.unknown, name + ".images", unknown);
  write_columns(file, order.rider, name + ".riders", rider);
}

void SecantPairs::load(io::CheckpointReader& file, const std::string& name, const IterateOrder& order) {
  qr_.load(file, name, order.unknown);
  const auto m = std::size_t(qr_.columns());
  std::vector<std::vector<double>> unknown = read_columns(file, order.unknown, name + ".images", m),
                                   rider = read_columns(file, order.rider, name + ".riders", m);
  images_.clear();
  for (std::size_t j = 0; j < m; ++j) images_.push_back({std::move(unknown[j]), std::move(rider[j])});
}

std::optional<Secants::Pair> Secants::pair(const Iterate& x, const Iterate& image) {
  Pair now{difference(image.unknown, x.unknown), image};
  std::optional<Pair> result;
  growth_ = 0;
  if (last_) {
    result =
        Pair{difference(now.residual, last_->residual),
             {difference(image.unknown, last_->image.unknown), difference(image.rider, last_->image.rider)}};
    std::array<double, 3> squares{dot(now.residual, now.residual), dot(last_->residual, last_->residual),
                                  dot(result->residual, result->residual)};
    sum_over(comm_, squares);
    growth_ = squares[1] > 0 ? std::sqrt(squares[0] / squares[1]) : 0;
    if (!(squares[2] > 0)) result.reset();
  }
  last_ = std::move(now);
  return result;
}

bool Secants::finite(const Iterate& x) const {
  // Zero times what is not finite is not a number, and so is its sum with anything.
  double sums[4] = {}, wrong = 0;
  for (std::size_t i = 0; i + 4 <= x.unknown.size(); i += 4)
    for (std::size_t k = 0; k < 4; ++k) sums[k] += 0 * x.unknown[i + k];
  for (std::size_t i = x.unknown.size() / 4 * 4; i < x.unknown.size(); ++i) sums[0] += 0 * x.unknown[i];
  wrong = sums[0] + sums[1] + sums[2] + sums[3] == 0 ? 0 : 1;
  sum_over(comm_, {&wrong, 1});
  return wrong == 0;
}

double Secants::share(const Iterate& x, const Iterate& next) const {
  using Vector = Eigen::Map<const Eigen::VectorXd>;
  const auto n = Eigen::Index(x.unknown.size());
  const Vector r(residual().data(), n), from(x.unknown.data(), n), to(next.unknown.data(), n);
  std::array<double, 2> sums{(to - from).dot(r), r.squaredNorm()};
  sum_over(comm_, sums);
  return sums[1] > 0 ? sums[0] / sums[1] : 0;
}

}  // namespace couplet::coupler
