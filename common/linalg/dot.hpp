// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <mpi.h>

#include <array>
#include <cstddef>
#include <span>

namespace couplet::linalg {

/// Sum of the products over this rank's entries, in several partial sums, so that additions do not wait for
/// each other.
inline double dot_here(std::span<const double> a, std::span<const double> b) {
  std::array<double, 8> sum{};
  std::size_t i = 0;
  for (; i + 8 <= b.size(); i += 8)
    for (std::size_t k = 0; k < 8; ++k) sum[k] += a[i + k] * b[i + k];
  for (; i < b.size(); ++i) sum[0] += a[i] * b[i];
  return ((sum[0] + sum[4]) + (sum[1] + sum[5])) + ((sum[2] + sum[6]) + (sum[3] + sum[7]));
}

/// Sums over all ranks. Collective.
template <std::size_t N>
std::array<double, N> over_ranks(MPI_Comm comm, std::array<double, N> local) {
  MPI_Allreduce(MPI_IN_PLACE, local.data(), N, MPI_DOUBLE, MPI_SUM, comm);
  return local;
}

}  // namespace couplet::linalg
