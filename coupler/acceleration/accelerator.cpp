// SPDX-License-Identifier: Apache-2.0
#include "coupler/acceleration/accelerator.hpp"

#include <fmt/format.h>

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>

#include "common/io/checkpoint.hpp"
#include "coupler/acceleration/quasi_newton.hpp"

namespace couplet::coupler {

void sum_over(MPI_Comm comm, std::span<double> values) {
  MPI_Allreduce(MPI_IN_PLACE, values.data(), static_cast<int>(values.size()), MPI_DOUBLE, MPI_SUM, comm);
}

double dot(std::span<const double> a, std::span<const double> b) {
  assert(a.size() == b.size());
  // Uses several partial sums, because a single one would wait for each addition.
  using Vector = Eigen::Map<const Eigen::VectorXd>;
  return Vector(a.data(), Eigen::Index(a.size())).dot(Vector(b.data(), Eigen::Index(b.size())));
}

ChangeSquares squares_of_change(std::span<const double> a, std::span<const double> b) {
  assert(a.size() == b.size());
  using Vector = Eigen::Map<const Eigen::VectorXd>;
  ChangeSquares sums;
  for_blocks(a.size(), [&](std::size_t first, std::size_t count) {
    const Vector here(a.data() + first, Eigen::Index(count)), there(b.data() + first, Eigen::Index(count));
    sums.change += (here - there).squaredNorm();
    sums.size += here.squaredNorm();
  });
  return sums;
}

namespace {

void relax(std::vector<double>& x, double omega, const std::vector<double>& image) {
  for (std::size_t i = 0; i < x.size(); ++i) x[i] += omega * (image[i] - x[i]);
}

}  // namespace

void relax(Iterate& x, double omega, const Iterate& image) {
  relax(x.unknown, omega, image.unknown);
  relax(x.dependent, omega, image.dependent);
}

std::unique_ptr<Accelerator> make_accelerator(const AccelerationParameters& parameters, MPI_Comm comm) {
  switch (parameters.type) {
    case AccelerationParameters::Type::constant:
      return std::make_unique<ConstantRelaxation>(parameters.initial_relaxation);
    case AccelerationParameters::Type::aitken:
      return std::make_unique<AitkenRelaxation>(parameters, comm);
    case AccelerationParameters::Type::iqn_ils:
      return std::make_unique<QuasiNewton>(parameters, comm);
  }
  return nullptr;
}

void visit_columns(io::Archive& archive, const parallel::GlobalOrder& order, const std::string& name,
                   std::vector<std::vector<double>>& columns, std::size_t m) {
  const std::size_t n = order.n_local();
  std::vector<double> rows(n * m);
  if (archive.reads()) columns.assign(m, std::vector<double>(n));
  for (std::size_t j = 0; j < m; ++j)
    for (std::size_t i = 0; i < n; ++i) rows[i * m + j] = columns[j][i];
  archive.field(order, name, rows);
  if (!archive.reads()) return;
  for (std::size_t j = 0; j < m; ++j)
    for (std::size_t i = 0; i < n; ++i) columns[j][i] = rows[i * m + j];
}

double aitken_factor(double omega, std::span<const double> residual, std::span<const double> next_residual,
                     MPI_Comm comm) {
  assert(residual.size() == next_residual.size());
  using Vector = Eigen::Map<const Eigen::VectorXd>;
  std::array<double, 2> sums{};  // r . change, |change|^2
  for_blocks(residual.size(), [&](std::size_t first, std::size_t count) {
    const Vector r(residual.data() + first, Eigen::Index(count)),
        next(next_residual.data() + first, r.size());
    sums[0] += r.dot(next - r);
    sums[1] += (next - r).squaredNorm();
  });
  sum_over(comm, sums);
  return sums[1] > 0 ? -omega * sums[0] / sums[1] : omega;
}

Iterate ConstantRelaxation::next(Iterate x, const Iterate& image) {
  relax(x, omega_, image);
  return x;
}

AitkenRelaxation::AitkenRelaxation(const AccelerationParameters& parameters, MPI_Comm comm)
    : parameters_(parameters),
      comm_(comm),
      omega_(parameters.initial_relaxation),
      first_(parameters.initial_relaxation) {}

void AitkenRelaxation::start_step() {
  forget_pass();
  omega_ = first_;
  second_pass_ = false;
}

void AitkenRelaxation::take_residual(const Iterate& x, const Iterate& image) {
  const std::size_t n = x.unknown.size(), m = x.dependent.size();
  residual_.resize(n + m);  // of its size already but in the first pass
  double* r = residual_.data();
  for (std::size_t i = 0; i < n; ++i) r[i] = image.unknown[i] - x.unknown[i];
  for (std::size_t i = 0; i < m; ++i) r[n + i] = image.dependent[i] - x.dependent[i];
  if (m == 0) return;
  if (!knows_pass_) {
    const std::span<const double> own(r, n), dependents(r + n, m);
    std::array<double, 2> squares{dot(own, own), dot(dependents, dependents)};
    sum_over(comm_, squares);
    dependent_weight_ = squares[1] > 0 ? std::sqrt(squares[0] / squares[1]) : 0;
  }
  for (std::size_t i = n; i < n + m; ++i) r[i] *= dependent_weight_;
}

void AitkenRelaxation::learn() {
  if (!knows_pass_) return;
  omega_ = std::clamp(aitken_factor(omega_, last_residual_, residual_, comm_), -10., 10.);
  if (second_pass_) first_ = std::clamp(std::abs(omega_), 1e-3, 1.);
}

Iterate AitkenRelaxation::next(Iterate x, const Iterate& image) {
  take_residual(x, image);
  learn();
  second_pass_ = !knows_pass_;
  knows_pass_ = true;
  std::swap(residual_, last_residual_);
  relax(x, omega_, image);
  return x;
}

void AitkenRelaxation::accept(const Iterate& x, const Iterate& image) {
  // In a step of two passes, the second factor is only known now.
  if (second_pass_) {
    take_residual(x, image);
    learn();
  }
  forget_pass();
}

bool has_converged(const std::vector<Residual>& residuals, const ConvergenceParameters& parameters) {
  return std::ranges::all_of(residuals, [&](const Residual& r) {
    return r.relative <= parameters.relative || r.absolute <= parameters.absolute;
  });
}

Residual worst(const std::vector<Residual>& residuals) {
  Residual all;
  for (const Residual& r : residuals)  // not a number stays not a number
    if (!(r.relative <= all.relative) && !std::isnan(all.relative)) all = r;
  return all;
}

double largest(const std::vector<Residual>& residuals, const std::vector<double>& scales) {
  double most = 0;
  for (std::size_t i = 0; i < residuals.size(); ++i)
    if (scales[i] > 0) most = std::max(most, residuals[i].absolute / scales[i]);
  return most;
}

}  // namespace couplet::coupler
