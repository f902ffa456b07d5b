// SPDX-License-Identifier: Apache-2.0
#include "common/parallel/collective.hpp"

#include <numeric>

namespace couplet::parallel {

namespace {

template <class T>
T reduce(MPI_Comm comm, T value, MPI_Datatype type, MPI_Op op) {
  MPI_Allreduce(MPI_IN_PLACE, &value, 1, type, op, comm);
  return value;
}

std::vector<int> offsets(const std::vector<int>& counts) {
  std::vector<int> first(counts.size() + 1, 0);
  std::partial_sum(counts.begin(), counts.end(), first.begin() + 1);
  return first;
}

}  // namespace

int comm_rank(MPI_Comm comm) {
  int rank = 0;
  MPI_Comm_rank(comm, &rank);
  return rank;
}

int comm_size(MPI_Comm comm) {
  int size = 1;
  MPI_Comm_size(comm, &size);
  return size;
}

double sum(MPI_Comm comm, double value) { return reduce(comm, value, MPI_DOUBLE, MPI_SUM); }
double max(MPI_Comm comm, double value) { return reduce(comm, value, MPI_DOUBLE, MPI_MAX); }
double min(MPI_Comm comm, double value) { return reduce(comm, value, MPI_DOUBLE, MPI_MIN); }
GlobalIndex sum(MPI_Comm comm, GlobalIndex value) { return reduce(comm, value, MPI_INT64_T, MPI_SUM); }
bool any(MPI_Comm comm, bool value) { return reduce(comm, value ? 1 : 0, MPI_INT, MPI_MAX) != 0; }

GlobalIndex exclusive_scan(MPI_Comm comm, GlobalIndex value) {
  GlobalIndex before = 0;
  MPI_Exscan(&value, &before, 1, MPI_INT64_T, MPI_SUM, comm);
  return comm_rank(comm) == 0 ? 0 : before;
}

void broadcast(MPI_Comm comm, std::string& text, int root) {
  int length = static_cast<int>(text.size());
  MPI_Bcast(&length, 1, MPI_INT, root, comm);
  text.resize(length);
  MPI_Bcast(text.data(), length, MPI_CHAR, root, comm);
}

namespace detail {

std::vector<char> all_gather_bytes(MPI_Comm comm, const void* data, std::size_t bytes) {
  std::vector<int> counts(comm_size(comm));
  const int count = static_cast<int>(bytes);
  MPI_Allgather(&count, 1, MPI_INT, counts.data(), 1, MPI_INT, comm);
  const std::vector<int> first = offsets(counts);
  std::vector<char> all(first.back());
  MPI_Allgatherv(data, count, MPI_BYTE, all.data(), counts.data(), first.data(), MPI_BYTE, comm);
  return all;
}

std::vector<char> gather_bytes(MPI_Comm comm, const void* data, std::size_t bytes) {
  std::vector<int> counts(comm_size(comm));
  const int count = static_cast<int>(bytes);
  MPI_Gather(&count, 1, MPI_INT, counts.data(), 1, MPI_INT, 0, comm);
  const std::vector<int> first = offsets(counts);
  std::vector<char> all(comm_rank(comm) == 0 ? first.back() : 0);
  MPI_Gatherv(data, count, MPI_BYTE, all.data(), counts.data(), first.data(), MPI_BYTE, 0, comm);
  return all;
}

std::vector<std::vector<char>> all_to_all_bytes(MPI_Comm comm, const std::vector<std::vector<char>>& send) {
  const int size = comm_size(comm);
  std::vector<int> send_counts(size), receive_counts(size);
  for (int r = 0; r < size; ++r) send_counts[r] = static_cast<int>(send[r].size());
  MPI_Alltoall(send_counts.data(), 1, MPI_INT, receive_counts.data(), 1, MPI_INT, comm);
  const std::vector<int> send_first = offsets(send_counts), receive_first = offsets(receive_counts);
  std::vector<char> out(send_first.back()), in(receive_first.back());
  for (int r = 0; r < size; ++r) std::copy(send[r].begin(), send[r].end(), out.begin() + send_first[r]);
  MPI_Alltoallv(out.data(), send_counts.data(), send_first.data(), MPI_BYTE, in.data(), receive_counts.data(),
                receive_first.data(), MPI_BYTE, comm);
  std::vector<std::vector<char>> received(size);
  for (int r = 0; r < size; ++r)
    received[r].assign(in.begin() + receive_first[r], in.begin() + receive_first[r + 1]);
  return received;
}

}  // namespace detail

}  // namespace couplet::parallel
