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

void broadcast(MPI_Comm comm, std::vector<std::string>& texts) {
  int size = static_cast<int>(texts.size());
  MPI_Bcast(&size, 1, MPI_INT, 0, comm);
  texts.resize(size);
  for (std::string& text : texts) broadcast(comm, text);
}

void throw_together(MPI_Comm comm, const std::string& text) {
  const int none = comm_size(comm);
  int first = text.empty() ? none : comm_rank(comm);
  MPI_Allreduce(MPI_IN_PLACE, &first, 1, MPI_INT, MPI_MIN, comm);
  if (first == none) return;
  std::string agreed = text;
  broadcast(comm, agreed, first);
  throw Error(agreed);
}

std::vector<char> detail::gather_bytes(MPI_Comm comm, const void* data, std::size_t bytes, bool everywhere) {
  std::vector<int> counts(comm_size(comm)), first(counts.size() + 1, 0);
  const int count = static_cast<int>(bytes);
  MPI_Allgather(&count, 1, MPI_INT, counts.data(), 1, MPI_INT, comm);
  std::partial_sum(counts.begin(), counts.end(), first.begin() + 1);
  std::vector<char> all(everywhere || comm_rank(comm) == 0 ? first.back() : 0);
  if (everywhere)
    MPI_Allgatherv(data, count, MPI_BYTE, all.data(), counts.data(), first.data(), MPI_BYTE, comm);
  else
    MPI_Gatherv(data, count, MPI_BYTE, all.data(), counts.data(), first.data(), MPI_BYTE, 0, comm);
  return all;
}

}  // namespace couplet::parallel
