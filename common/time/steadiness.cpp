// SPDX-License-Identifier: Apache-2.0
#include "common/time/steadiness.hpp"

#include <array>

#include "common/parallel/collective.hpp"

namespace couplet::time {
namespace {

/// Sums over all ranks of (x - y)^2, x^2 and 1.
std::array<double, 3> sums_of(MPI_Comm comm, std::span<const double> now, std::span<const double> before) {
  std::array<double, 3> sums{0, 0, double(now.size())};
  for (std::size_t i = 0; i < now.size(); ++i) {
    sums[0] += (now[i] - before[i]) * (now[i] - before[i]);
    sums[1] += now[i] * now[i];
  }
  MPI_Allreduce(MPI_IN_PLACE, sums.data(), 3, MPI_DOUBLE, MPI_SUM, comm);
  return sums;
}

}  // namespace

double change_over_size(MPI_Comm comm, std::span<const double> now, std::span<const double> before) {
  const auto [change, size, number] = sums_of(comm, now, before);
  return change > 0 ? std::sqrt(change / size) : 0;
}

double change_over_range(MPI_Comm comm, std::span<const double> now, std::span<const double> before) {
  const auto [change, size, number] = sums_of(comm, now, before);
  double lowest = std::numeric_limits<double>::infinity(), highest = -lowest;
  for (const double value : now) lowest = std::min(lowest, value), highest = std::max(highest, value);
  const double range = parallel::max(comm, highest) - parallel::min(comm, lowest);
  return change > 0 ? std::sqrt(change / number) / range : 0;
}

}  // namespace couplet::time
