// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <mpi.h>

#include <string>
#include <vector>

#include "common/base/types.hpp"

namespace couplet::parallel {

int comm_rank(MPI_Comm comm);
int comm_size(MPI_Comm comm);

double sum(MPI_Comm comm, double value);
double max(MPI_Comm comm, double value);
double min(MPI_Comm comm, double value);
GlobalIndex sum(MPI_Comm comm, GlobalIndex value);
/// True on every rank if it is true on any.
bool any(MPI_Comm comm, bool value);
/// Sum over the ranks before this one (0 on rank 0).
GlobalIndex exclusive_scan(MPI_Comm comm, GlobalIndex value);

void broadcast(MPI_Comm comm, std::string& text, int root = 0);

/// All values of all ranks, rank by rank, on every rank.
template <class T>
std::vector<T> all_gather(MPI_Comm comm, const std::vector<T>& local);
/// The same on rank 0 only (empty elsewhere).
template <class T>
std::vector<T> gather(MPI_Comm comm, const std::vector<T>& local);
/// send[r] goes to rank r; the result holds at [r] what rank r sent here. Any trivially copyable T.
template <class T>
std::vector<std::vector<T>> all_to_all(MPI_Comm comm, const std::vector<std::vector<T>>& send);

namespace detail {
std::vector<char> all_gather_bytes(MPI_Comm comm, const void* data, std::size_t bytes);
std::vector<char> gather_bytes(MPI_Comm comm, const void* data, std::size_t bytes);
std::vector<std::vector<char>> all_to_all_bytes(MPI_Comm comm, const std::vector<std::vector<char>>& send);
template <class T>
std::vector<T> from_bytes(const std::vector<char>& bytes) {
  std::vector<T> values(bytes.size() / sizeof(T));
  if (!values.empty()) std::copy(bytes.begin(), bytes.end(), reinterpret_cast<char*>(values.data()));
  return values;
}
}  // namespace detail

template <class T>
std::vector<T> all_gather(MPI_Comm comm, const std::vector<T>& local) {
  return detail::from_bytes<T>(detail::all_gather_bytes(comm, local.data(), local.size() * sizeof(T)));
}

template <class T>
std::vector<T> gather(MPI_Comm comm, const std::vector<T>& local) {
  return detail::from_bytes<T>(detail::gather_bytes(comm, local.data(), local.size() * sizeof(T)));
}

template <class T>
std::vector<std::vector<T>> all_to_all(MPI_Comm comm, const std::vector<std::vector<T>>& send) {
  std::vector<std::vector<char>> bytes(send.size());
  for (std::size_t r = 0; r < send.size(); ++r) {
    const char* first = reinterpret_cast<const char*>(send[r].data());
    bytes[r].assign(first, first + send[r].size() * sizeof(T));
  }
  std::vector<std::vector<T>> received;
  for (const auto& part : detail::all_to_all_bytes(comm, bytes))
    received.push_back(detail::from_bytes<T>(part));
  return received;
}

}  // namespace couplet::parallel
