// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <cmath>

#include "common/io/checkpoint.hpp"
#include "coupler/quasi_newton.hpp"

namespace couplet {
namespace {

std::vector<double> difference(const std::vector<double>& a, const std::vector<double>& b) {
  std::vector<double> result(a.size());
  for (std::size_t i = 0; i < a.size(); ++i) result[i] = a[i] - b[i];
  return result;
}

void add_to(std::vector<double>& y, double factor, const std::vector<double>& x) {
  for (std::size_t i = 0; i < y.size(); ++i) y[i] += factor * x[i];
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
  for (int j = 0; j < columns(); ++j) {
    add_to(to.unknown, c[j], images_[j].unknown);
    add_to(to.rider, c[j], images_[j].rider);
  }
}

void SecantPairs::save(CheckpointWriter& file, const std::string& name) const {
  qr_.save(file, name);
  std::vector<double> unknown, rider;
  for (const Iterate& image : images_) {
    unknown.insert(unknown.end(), image.unknown.begin(), image.unknown.end());
    rider.insert(rider.end(), image.rider.begin(), image.rider.end());
  }
  file.write(name + ".images", unknown);
  file.write(name + ".riders", rider);
}

void SecantPairs::load(CheckpointReader& file, const std::string& name) {
  const std::vector<double> unknown = file.read(name + ".images"), rider = file.read(name + ".riders");
  const auto m = static_cast<std::size_t>(file.read_scalar(name + ".columns"));
  const std::size_t n = m > 0 ? unknown.size() / m : 0, n_rider = m > 0 ? rider.size() / m : 0;
  qr_.load(file, name, n);
  images_.clear();
  for (std::size_t j = 0; j < m; ++j) {
    Iterate& image = images_.emplace_back();
    image.unknown.assign(unknown.begin() + j * n, unknown.begin() + (j + 1) * n);
    image.rider.assign(rider.begin() + j * n_rider, rider.begin() + (j + 1) * n_rider);
  }
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
  double wrong = 0;
  for (const double v : x.unknown) wrong += !std::isfinite(v);
  sum_over(comm_, {&wrong, 1});
  return wrong == 0;
}

double Secants::share(const Iterate& x, const Iterate& next) const {
  std::array<double, 2> sums{dot(next.unknown, residual()) - dot(x.unknown, residual()),
                             dot(residual(), residual())};
  sum_over(comm_, sums);
  return sums[1] > 0 ? sums[0] / sums[1] : 0;
}

}  // namespace couplet
