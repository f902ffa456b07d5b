// SPDX-License-Identifier: Apache-2.0
#include "coupler/relaxation.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>

#include "common/io/checkpoint.hpp"

namespace couplet {
namespace {

std::vector<double> relaxed(const std::vector<double>& x, double omega, const std::vector<double>& image) {
  std::vector<double> result(x.size());
  for (std::size_t i = 0; i < x.size(); ++i) result[i] = x[i] + omega * (image[i] - x[i]);
  return result;
}

Iterate relaxed(const Iterate& x, double omega, const Iterate& image) {
  return {relaxed(x.unknown, omega, image.unknown), relaxed(x.rider, omega, image.rider)};
}

}  // namespace

double aitken_factor(double omega, std::span<const double> residual, std::span<const double> next_residual,
                     MPI_Comm comm) {
  assert(residual.size() == next_residual.size());
  using Vector = Eigen::Map<const Eigen::VectorXd>;
  const Vector r(residual.data(), Eigen::Index(residual.size())), next(next_residual.data(), r.size());
  std::array<double, 2> sums{r.dot(next - r), (next - r).squaredNorm()};  // r . change, |change|^2
  sum_over(comm, sums);
  return sums[1] > 0 ? -omega * sums[0] / sums[1] : omega;
}

Iterate ConstantRelaxation::next(const Iterate& x, const Iterate& image) { return relaxed(x, omega_, image); }

AitkenRelaxation::AitkenRelaxation(const AccelerationParameters& parameters, MPI_Comm comm)
    : parameters_(parameters),
      comm_(comm),
      omega_(parameters.initial_relaxation),
      first_(parameters.initial_relaxation) {}

void AitkenRelaxation::start_step() {
  last_residual_.reset();
  omega_ = first_;
  second_pass_ = false;
}

std::vector<double> AitkenRelaxation::residual_of(const Iterate& x, const Iterate& image) {
  const std::size_t n = x.unknown.size(), m = x.rider.size();
  std::vector<double> r(n + m);
  for (std::size_t i = 0; i < n; ++i) r[i] = image.unknown[i] - x.unknown[i];
  for (std::size_t i = 0; i < m; ++i) r[n + i] = image.rider[i] - x.rider[i];
  if (!last_residual_) {
    const std::span<const double> own(r.data(), n), riders(r.data() + n, m);
    std::array<double, 2> squares{dot(own, own), dot(riders, riders)};
    sum_over(comm_, squares);
    rider_weight_ = squares[1] > 0 ? std::sqrt(squares[0] / squares[1]) : 0;
  }
  for (std::size_t i = n; i < n + m; ++i) r[i] *= rider_weight_;
  return r;
}

void AitkenRelaxation::learn(std::span<const double> residual) {
  if (!last_residual_) return;
  const double most = 10 * parameters_.maximum_relaxation;
  omega_ = std::clamp(aitken_factor(omega_, *last_residual_, residual, comm_), -most, most);
  if (second_pass_)
    first_ = std::clamp(std::abs(omega_), std::min(1e-3, parameters_.maximum_relaxation),
                        parameters_.maximum_relaxation);
}

Iterate AitkenRelaxation::next(const Iterate& x, const Iterate& image) {
  std::vector<double> r = residual_of(x, image);
  const bool first = !last_residual_;
  learn(r);
  second_pass_ = first;
  last_residual_ = std::move(r);
  return relaxed(x, omega_, image);
}

void AitkenRelaxation::accept(const Iterate& x, const Iterate& image) {
  // A step of two passes has its second factor only now.
  if (second_pass_) learn(residual_of(x, image));
  last_residual_.reset();
}

void AitkenRelaxation::save(CheckpointWriter& file) const { file.write_scalar("omega", first_); }

void AitkenRelaxation::load(CheckpointReader& file) { first_ = file.read_scalar("omega"); }

}  // namespace couplet
