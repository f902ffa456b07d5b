// SPDX-License-Identifier: Apache-2.0
#include "common/linalg/residual_projection.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "common/base/error.hpp"
#include "common/base/numbers.hpp"
#include "common/linalg/matrix.hpp"

namespace couplet::linalg {
namespace {

// Squared relative size of an image below which a combination is noise of earlier tolerances.
constexpr double noise = 1e-12;
// Relative difference of images that round-off may cause if corrections are small compared to the solution.
constexpr double same_operator = 1e-3;

using Small = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, ResidualProjection::most,
                            ResidualProjection::most>;
using SmallVector = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, ResidualProjection::most, 1>;

}  // namespace

bool ResidualProjection::project(std::span<double> r, std::span<double> x) {
  pending_.x.assign(x.begin(), x.end());
  pending_.image.assign(r.begin(), r.end());
  is_pending_ = false;
  const int n = static_cast<int>(kept_.size());
  if (n == 0) return false;
  std::array<double, most> along{};
  for (int k = 0; k < n; ++k) along[k] = dot_here(kept_[k].image, r);
  MPI_Allreduce(MPI_IN_PLACE, along.data(), n, MPI_DOUBLE, MPI_SUM, comm_);
  // Images are scaled to unit length, because new corrections may be much smaller than old ones.
  SmallVector scale(n), b(n);
  for (int k = 0; k < n; ++k) {
    scale[k] = gram_(k, k) > 0 ? 1 / std::sqrt(gram_(k, k)) : 0;
    b[k] = along[k] * scale[k];
  }
  const Small scaled = scale.asDiagonal() * gram_.topLeftCorner(n, n) * scale.asDiagonal();
  const Eigen::SelfAdjointEigenSolver<Small> eigen(scaled);
  const SmallVector& values = eigen.eigenvalues();
  SmallVector y = eigen.eigenvectors().transpose() * b;
  for (int k = 0; k < n; ++k) y[k] = values[k] > noise * values[n - 1] ? y[k] / values[k] : 0;
  y = scale.cwiseProduct(eigen.eigenvectors() * y);
  for (int k = 0; k < n; ++k) {
    const Correction& c = kept_[k];
    for (std::size_t i = 0; i < r.size(); ++i) {
      x[i] += y[k] * c.x[i];
      r[i] -= y[k] * c.image[i];
    }
  }
  return true;
}

void ResidualProjection::finish(std::span<const double> r, std::span<const double> x) {
  for (std::size_t i = 0; i < x.size(); ++i) {
    pending_.x[i] = x[i] - pending_.x[i];
    pending_.image[i] -= r[i];
  }
  is_pending_ = true;
}

void ResidualProjection::accept() {
  if (!is_pending_) return;
  is_pending_ = false;
  const auto depth = static_cast<std::size_t>(depth_);
  const std::size_t place = kept_.size() < depth ? kept_.size() : oldest_;
  if (place == kept_.size())
    kept_.emplace_back();
  else
    oldest_ = (oldest_ + 1) % depth;
  std::swap(kept_[place], pending_);
  std::array<double, most> with{};
  const int n = static_cast<int>(kept_.size());
  for (int k = 0; k < n; ++k) with[k] = dot_here(kept_[k].image, kept_[place].image);
  MPI_Allreduce(MPI_IN_PLACE, with.data(), n, MPI_DOUBLE, MPI_SUM, comm_);
  for (int k = 0; k < n; ++k) gram_(k, place) = gram_(place, k) = with[k];
}

std::vector<double> ResidualProjection::products() const {
  base::Numbers numbers;
  std::size_t n = kept_.size(), oldest = oldest_;
  auto gram = gram_;
  numbers(n, oldest);
  numbers.fill({gram.data(), std::size_t(gram.size())});
  return numbers.values();
}

std::vector<std::span<const double>> ResidualProjection::vectors() const {
  std::vector<std::span<const double>> vectors;
  for (const Correction& c : kept_) vectors.insert(vectors.end(), {c.x, c.image});
  return vectors;
}

std::size_t ResidualProjection::vectors_of(std::span<const double> products) {
  base::Numbers saved(products, "corrections of solves");
  std::size_t n = 0;
  saved(n);
  if (n > most) saved.damaged();
  return 2 * n;
}

void ResidualProjection::set_values(std::span<const double> products,
                                    std::vector<std::vector<double>> vectors, const LinearMap& apply) {
  base::Numbers saved(products, "corrections of solves");
  std::size_t n = 0;
  saved(n, oldest_);
  saved.fill({gram_.data(), std::size_t(gram_.size())});
  saved.finish();
  if (n > most || oldest_ > most || vectors.size() != 2 * n) saved.damaged();
  kept_.assign(n, {});
  is_pending_ = false;
  bool fits = kept_.size() <= std::size_t(depth_) && oldest_ < std::size_t(std::max(depth_, 1));
  std::vector<double> image;
  for (std::size_t k = 0; k < kept_.size(); ++k) {
    Correction& c = kept_[k];
    c.x = std::move(vectors[2 * k]), c.image = std::move(vectors[2 * k + 1]);
    image.assign(c.image.size(), 0.);
    apply(c.x, image);
    for (std::size_t i = 0; i < image.size(); ++i) image[i] -= c.image[i];
    std::array<double, 2> square = {dot_here(image, image), dot_here(c.image, c.image)};
    MPI_Allreduce(MPI_IN_PLACE, square.data(), 2, MPI_DOUBLE, MPI_SUM, comm_);
    fits = fits && square[0] <= same_operator * same_operator * square[1];
  }
  if (!fits) kept_.clear(), oldest_ = 0;
}

}  // namespace couplet::linalg
