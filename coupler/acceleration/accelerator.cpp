// SPDX-License-Identifier: Apache-2.0
#include "coupler/acceleration/accelerator.hpp"

#include <Eigen/Core>
#include <cassert>

#include "common/io/checkpoint.hpp"
#include "coupler/acceleration/quasi_newton.hpp"
#include "coupler/acceleration/relaxation.hpp"

namespace couplet::coupler {

void sum_over(MPI_Comm comm, std::span<double> values) {
  MPI_Allreduce(MPI_IN_PLACE, values.data(), static_cast<int>(values.size()), MPI_DOUBLE, MPI_SUM, comm);
}

double dot(std::span<const double> a, std::span<const double> b) {
  assert(a.size() == b.size());
  // Several sums side by side: one alone waits for each addition.
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
  relax(x.rider, omega, image.rider);
}

std::unique_ptr<Accelerator> make_accelerator(const AccelerationParameters& parameters, MPI_Comm comm) {
  switch (parameters.type) {
    case AccelerationParameters::Type::constant:
      return std::make_unique<ConstantRelaxation>(parameters.initial_relaxation);
    case AccelerationParameters::Type::aitken:
      return std::make_unique<AitkenRelaxation>(parameters, comm);
    case AccelerationParameters::Type::iqn_ils:
      return std::make_unique<LeastSquaresNewton>(parameters, comm);
    case AccelerationParameters::Type::iqn_mvj:
      return std::make_unique<MultiVectorNewton>(parameters, comm);
  }
  return nullptr;
}

void write_columns(io::CheckpointWriter& file, const parallel::GlobalOrder& order, const std::string& name,
                   const Columns& columns) {
  const std::size_t n = order.n_local(), m = columns.size();
  std::vector<double> rows(n * m);
  for (std::size_t j = 0; j < m; ++j)
    for (std::size_t i = 0; i < n; ++i) rows[i * m + j] = columns[j][i];
  file.write(order, name, rows);
}

std::vector<std::vector<double>> read_columns(io::CheckpointReader& file, const parallel::GlobalOrder& order,
                                              const std::string& name, std::size_t m) {
  const std::size_t n = order.n_local();
  std::vector<double> rows(n * m);
  file.read(order, name, rows);
  std::vector<std::vector<double>> columns(m, std::vector<double>(n));
  for (std::size_t j = 0; j < m; ++j)
    for (std::size_t i = 0; i < n; ++i) columns[j][i] = rows[i * m + j];
  return columns;
}

}  // namespace couplet::coupler
