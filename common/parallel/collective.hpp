// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <mpi.h>

#include <algorithm>
#include <exception>
#include <limits>
#include <span>
#include <string>
#include <type_traits>
#include <vector>

#include "common/base/error.hpp"
#include "common/base/types.hpp"

namespace couplet::parallel {

int comm_rank(MPI_Comm comm);
int comm_size(MPI_Comm comm);

double sum(MPI_Comm comm, double value);
double max(MPI_Comm comm, double value);
double min(MPI_Comm comm, double value);
GlobalIndex sum(MPI_Comm comm, GlobalIndex value);
/// Returns true on every rank if `value` is true on any.
bool any(MPI_Comm comm, bool value);
/// Sum over the ranks before this one (0 on rank 0).
GlobalIndex exclusive_scan(MPI_Comm comm, GlobalIndex value);

void broadcast(MPI_Comm comm, std::string& text, int root = 0);
void broadcast(MPI_Comm comm, std::vector<std::string>& texts);
/// Broadcasts rank 0's values, in pieces that fit MPI's int counts. Collective.
template <class T>
void broadcast(MPI_Comm comm, std::vector<T>& values) {
  GlobalIndex size = static_cast<GlobalIndex>(values.size());
  MPI_Bcast(&size, 1, MPI_INT64_T, 0, comm);
  values.resize(size);
  char* data = reinterpret_cast<char*>(values.data());
  const GlobalIndex bytes = size * GlobalIndex(sizeof(T)), piece = GlobalIndex(1) << 30;
  for (GlobalIndex at = 0; at < bytes; at += piece)
    MPI_Bcast(data + at, static_cast<int>(std::min(piece, bytes - at)), MPI_BYTE, 0, comm);
}

/// Throws the text of the lowest rank that has one on every rank. Does nothing if all are empty. Collective.
void throw_together(MPI_Comm comm, const std::string& text);

/// Runs `work` on every rank and returns its result. The exception of the lowest rank that throws is thrown
/// on all, as Error with the same text. `work` must not use MPI. Collective.
template <class Work>
auto on_all(MPI_Comm comm, Work&& work) {
  using Result = decltype(work());
  std::conditional_t<std::is_void_v<Result>, int, Result> result{};
  std::string trouble;
  try {
    if constexpr (std::is_void_v<Result>)
      work();
    else
      result = work();
  } catch (const std::exception& e) {
    trouble = e.what();
  }
  throw_together(comm, trouble);
  if constexpr (!std::is_void_v<Result>) return result;
}
/// Runs `work` likewise, but only on rank 0.
template <class Work>
void on_root(MPI_Comm comm, Work&& work) {
  on_all(comm, [&] {
    if (comm_rank(comm) == 0) work();
  });
}

namespace detail {
std::vector<char> gather_bytes(MPI_Comm comm, const void* data, std::size_t bytes, bool everywhere);
template <class T>
std::vector<T> from_bytes(const std::vector<char>& bytes) {
  std::vector<T> values(bytes.size() / sizeof(T));
  if (!values.empty()) std::copy(bytes.begin(), bytes.end(), reinterpret_cast<char*>(values.data()));
  return values;
}
}  // namespace detail

/// Gathers the values of all ranks, rank by rank, on every rank. T must be trivially copyable.
template <class T>
std::vector<T> all_gather(MPI_Comm comm, const std::vector<T>& local) {
  return detail::from_bytes<T>(detail::gather_bytes(comm, local.data(), local.size() * sizeof(T), true));
}
/// Gathers the values on rank 0 only (empty elsewhere).
template <class T>
std::vector<T> gather(MPI_Comm comm, const std::vector<T>& local) {
  return detail::from_bytes<T>(detail::gather_bytes(comm, local.data(), local.size() * sizeof(T), false));
}

/// Items to or from each rank in one array: those of rank r are [first[r], first[r + 1]).
template <class T>
struct Parcels {
  std::vector<T> items;
  std::vector<std::size_t> first;
  std::span<const T> of(int rank) const {
    return {items.data() + first[rank], first[rank + 1] - first[rank]};
  }
  std::span<T> of(int rank) { return {items.data() + first[rank], first[rank + 1] - first[rank]}; }
};

/// Allocates `count[r]` items for each rank.
template <class T>
Parcels<T> make_parcels(const std::vector<std::size_t>& count) {
  Parcels<T> parcels;
  parcels.first.assign(1, 0);
  for (const std::size_t n : count) parcels.first.push_back(parcels.first.back() + n);
  parcels.items.resize(parcels.first.back());
  return parcels;
}

/// Sorts `items` by the rank that `rank_of` returns, in their order.
template <class T, class RankOf>
Parcels<T> sort_by_rank(MPI_Comm comm, const std::vector<T>& items, RankOf&& rank_of) {
  std::vector<std::size_t> count(comm_size(comm), 0);
  for (const T& item : items) ++count[rank_of(item)];
  Parcels<T> parcels = make_parcels<T>(count);
  std::vector<std::size_t> next(parcels.first.begin(), parcels.first.end() - 1);
  for (const T& item : items) parcels.items[next[rank_of(item)]++] = item;
  return parcels;
}

/// Sends each rank its parcel and returns those received. T is copied byte by byte. Collective.
template <class T>
Parcels<T> exchange(MPI_Comm comm, const Parcels<T>& out) {
  const int size = comm_size(comm);
  std::vector<int> out_count(size), in_count(size), out_first(size), in_first(size);
  const auto too_many = [](std::size_t n) { return n > std::size_t(std::numeric_limits<int>::max()); };
  for (int r = 0; r < size; ++r) {
    out_count[r] = static_cast<int>(out.first[r + 1] - out.first[r]);
    out_first[r] = static_cast<int>(out.first[r]);
  }
  MPI_Alltoall(out_count.data(), 1, MPI_INT, in_count.data(), 1, MPI_INT, comm);
  Parcels<T> in = make_parcels<T>({in_count.begin(), in_count.end()});
  if (any(comm, too_many(out.items.size()) || too_many(in.items.size())))
    throw Error("A rank would have to exchange more than 2^31 entries at once. Start more processes.");
  for (int r = 0; r < size; ++r) in_first[r] = static_cast<int>(in.first[r]);
  MPI_Datatype type = MPI_DATATYPE_NULL;
  MPI_Type_contiguous(static_cast<int>(sizeof(T)), MPI_BYTE, &type);
  MPI_Type_commit(&type);
  MPI_Alltoallv(out.items.data(), out_count.data(), out_first.data(), type, in.items.data(), in_count.data(),
                in_first.data(), type, comm);
  MPI_Type_free(&type);
  return in;
}

/// Does the same with one list per rank: send[r] goes to rank r, and result[r] comes from rank r.
template <class T>
std::vector<std::vector<T>> all_to_all(MPI_Comm comm, const std::vector<std::vector<T>>& send) {
  std::vector<std::size_t> count;
  for (const auto& list : send) count.push_back(list.size());
  Parcels<T> out = make_parcels<T>(count);
  for (std::size_t r = 0; r < send.size(); ++r) std::ranges::copy(send[r], out.of(int(r)).begin());
  const Parcels<T> in = exchange(comm, out);
  std::vector<std::vector<T>> received;
  for (std::size_t r = 0; r < send.size(); ++r)
    received.emplace_back(in.of(int(r)).begin(), in.of(int(r)).end());
  return received;
}

}  // namespace couplet::parallel
