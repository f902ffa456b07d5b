// SPDX-License-Identifier: Apache-2.0
#include "common/parallel/index_map.hpp"

#include <algorithm>
#include <cassert>
#include <cstring>
#include <numeric>

#include "common/base/error.hpp"
#include "common/parallel/collective.hpp"

namespace couplet::parallel {

/// Communication pattern. Messages are packed rank by rank, in the same order on both sides.
struct IndexMap::Exchange {
  struct Peer {
    int rank;
    std::vector<Index> entries;
  };
  MPI_Comm comm = MPI_COMM_NULL;
  std::vector<Peer> owned_for;  // own entries that others hold as ghosts
  std::vector<Peer> ghosts_of;  // ghosts here that others own
  static constexpr int tag = 7001;

  /// Sends entries of `size` bytes and calls unpack(entry, its bytes) for received ones.
  template <class Unpack>
  void run(const std::vector<Peer>& from, const std::vector<Peer>& to, std::span<const std::byte> values,
           std::size_t size, Unpack&& unpack) const {
    std::vector<std::vector<std::byte>> in(to.size()), out(from.size());
    std::vector<MPI_Request> requests;
    requests.reserve(to.size() + from.size());
    for (std::size_t p = 0; p < to.size(); ++p) {
      in[p].resize(to[p].entries.size() * size);
      MPI_Irecv(in[p].data(), static_cast<int>(in[p].size()), MPI_BYTE, to[p].rank, tag, comm,
                &requests.emplace_back());
    }
    for (std::size_t p = 0; p < from.size(); ++p) {
      out[p].reserve(from[p].entries.size() * size);
      for (const Index e : from[p].entries) {
        const auto entry = values.subspan(std::size_t(e) * size, size);
        out[p].insert(out[p].end(), entry.begin(), entry.end());
      }
      MPI_Isend(out[p].data(), static_cast<int>(out[p].size()), MPI_BYTE, from[p].rank, tag, comm,
                &requests.emplace_back());
    }
    MPI_Waitall(static_cast<int>(requests.size()), requests.data(), MPI_STATUSES_IGNORE);
    for (std::size_t p = 0; p < to.size(); ++p)
      for (std::size_t i = 0; i < to[p].entries.size(); ++i)
        unpack(std::size_t(to[p].entries[i]), in[p].data() + i * size);
  }
};

IndexMap::IndexMap(MPI_Comm comm, Index n_owned, const std::vector<int>& ghost_owner,
                   const std::vector<Index>& ghost_remote)
    : n_owned_(n_owned), n_local_(n_owned + static_cast<Index>(ghost_owner.size())) {
  assert(ghost_owner.size() == ghost_remote.size());
  n_global_ = sum(comm, GlobalIndex(n_owned));
  first_ = exclusive_scan(comm, n_owned);
  global_.resize(n_local_);
  std::iota(global_.begin(), global_.begin() + n_owned, first_);

  const int size = comm_size(comm);
  std::vector<std::vector<Index>> wanted(size), ghosts(size);
  for (std::size_t g = 0; g < ghost_owner.size(); ++g) {
    wanted[ghost_owner[g]].push_back(ghost_remote[g]);
    ghosts[ghost_owner[g]].push_back(n_owned + static_cast<Index>(g));
  }
  const auto asked = all_to_all(comm, wanted);
  auto exchange = std::make_shared<Exchange>();
  exchange->comm = comm;
  for (int r = 0; r < size; ++r) {
    if (!asked[r].empty()) exchange->owned_for.push_back({r, asked[r]});
    if (!ghosts[r].empty()) exchange->ghosts_of.push_back({r, ghosts[r]});
  }
  exchange_ = exchange;
  update_ghosts(std::span<GlobalIndex>(global_));
}

void IndexMap::update_ghosts(std::span<std::byte> values, std::size_t size) const {
  assert(values.size() == std::size_t(n_local_) * size);
  if (!exchange_) return;
  exchange_->run(exchange_->owned_for, exchange_->ghosts_of, values, size,
                 [&](std::size_t entry, const std::byte* bytes) {
                   std::copy_n(bytes, size, values.begin() + std::ptrdiff_t(entry * size));
                 });
}

void IndexMap::update_ghosts(std::span<double> values, int components) const {
  update_ghosts(std::as_writable_bytes(values), std::size_t(components) * sizeof(double));
}

void IndexMap::update_ghosts(std::span<GlobalIndex> values) const {
  update_ghosts(std::as_writable_bytes(values), sizeof(GlobalIndex));
}

void IndexMap::add_to_owners(std::span<double> values, int components) const {
  assert(values.size() == std::size_t(n_local_) * components);
  if (!exchange_) return;
  const auto n = std::size_t(components);
  std::vector<double> come(n);
  exchange_->run(exchange_->ghosts_of, exchange_->owned_for, std::as_bytes(values), n * sizeof(double),
                 [&](std::size_t entry, const std::byte* bytes) {
                   std::memcpy(come.data(), bytes, n * sizeof(double));
                   for (std::size_t c = 0; c < n; ++c) values[entry * n + c] += come[c];
                 });
}

namespace {

std::vector<char> first_of(std::size_t n, std::size_t n_owned) {
  std::vector<char> owned(n, 0);
  std::fill_n(owned.begin(), n_owned, 1);
  return owned;
}

GlobalIndex largest(MPI_Comm comm, std::span<const GlobalIndex> ids) {
  GlobalIndex most = -1;
  for (const GlobalIndex id : ids) most = std::max(most, id);
  MPI_Allreduce(MPI_IN_PLACE, &most, 1, MPI_INT64_T, MPI_MAX, comm);
  return most;
}

}  // namespace

GlobalOrder::GlobalOrder(MPI_Comm comm, std::span<const GlobalIndex> ids, std::size_t n_owned)
    : GlobalOrder(comm, ids, first_of(ids.size(), n_owned)) {}

// Rank r has the existing numbers in [r, r + 1) chunk as its block, ascending.
GlobalOrder::GlobalOrder(MPI_Comm comm, std::span<const GlobalIndex> ids, const std::vector<char>& owned)
    : comm_(comm), n_local_(ids.size()) {
  const auto ranks = static_cast<std::size_t>(comm_size(comm));
  const GlobalIndex chunk = largest(comm, ids) / static_cast<GlobalIndex>(ranks) + 1;
  entries_.resize(ranks), rows_.resize(ranks), owned_.resize(ranks);
  std::vector<std::vector<GlobalIndex>> asked(ranks);
  bool wrong = false;
  for (std::size_t i = 0; i < ids.size(); ++i) {
    wrong = wrong || ids[i] < 0;
    const auto rank = static_cast<std::size_t>(std::max<GlobalIndex>(ids[i], 0) / chunk);
    entries_[rank].push_back(static_cast<Index>(i));
    owned_[rank].push_back(owned[i]);
    asked[rank].push_back(ids[i]);
  }
  asked = all_to_all(comm, asked);
  owned_there_ = all_to_all(comm, owned_);
  std::vector<GlobalIndex> mine;
  for (std::size_t r = 0; r < ranks; ++r)
    for (std::size_t k = 0; k < asked[r].size(); ++k)
      if (owned_there_[r][k]) mine.push_back(asked[r][k]);
  std::ranges::sort(mine);
  wrong = wrong || std::ranges::adjacent_find(mine) != mine.end();
  for (std::size_t r = 0; r < ranks; ++r)
    for (const GlobalIndex id : asked[r]) {
      const auto at = std::ranges::lower_bound(mine, id);
      wrong = wrong || at == mine.end() || *at != id;
      rows_[r].push_back(static_cast<Index>(at - mine.begin()));
    }
  if (any(comm, wrong)) throw Error("Each number of a distributed entry must be owned by exactly one rank.");
  count_ = mine.size();
  first_ = exclusive_scan(comm, static_cast<GlobalIndex>(count_));
  n_global_ = sum(comm, static_cast<GlobalIndex>(count_));
}

GlobalOrder GlobalOrder::as_they_are(MPI_Comm comm, std::size_t n) {
  std::vector<GlobalIndex> ids(n);
  std::iota(ids.begin(), ids.end(), exclusive_scan(comm, static_cast<GlobalIndex>(n)));
  return {comm, ids, n};
}

GlobalOrder GlobalOrder::by_numbers(MPI_Comm comm, std::span<const GlobalIndex> ids, std::size_t n) {
  if (any(comm, ids.size() != n)) return as_they_are(comm, n);
  try {
    return {comm, ids, n};
  } catch (const Error&) {  // on all ranks
    return as_they_are(comm, n);
  }
}

std::optional<GlobalOrder> GlobalOrder::of_rows(MPI_Comm comm, std::span<const GlobalIndex> rows,
                                                std::span<const GlobalIndex> ids) {
  if (!any(comm, !std::ranges::equal(rows, ids))) return std::nullopt;
  const GlobalOrder there(comm, rows, rows.size()), here(comm, ids, ids.size());
  const std::vector<double> numbers_there(rows.begin(), rows.end()), numbers_here(ids.begin(), ids.end());
  if (any(comm, there.to_block(numbers_there, 1) != here.to_block(numbers_here, 1)))
    throw Error("The numbers of the rows differ from those of the entries.");
  std::vector<double> row(rows.size());
  std::iota(row.begin(), row.end(), double(exclusive_scan(comm, static_cast<GlobalIndex>(rows.size()))));
  const std::vector<double> mine = here.from_block(there.to_block(row, 1), 1);
  const std::vector<GlobalIndex> places(mine.begin(), mine.end());
  return GlobalOrder(comm, places, places.size());
}

std::vector<double> GlobalOrder::to_block(std::span<const double> values, std::size_t width) const {
  std::vector<std::vector<double>> parts(entries_.size());
  for (std::size_t r = 0; r < parts.size(); ++r)
    for (std::size_t k = 0; k < entries_[r].size(); ++k)
      if (owned_[r][k]) {
        const auto from = values.begin() + std::ptrdiff_t(std::size_t(entries_[r][k]) * width);
        parts[r].insert(parts[r].end(), from, from + std::ptrdiff_t(width));
      }
  parts = all_to_all(comm_, parts);
  std::vector<double> block(count_ * width);
  for (std::size_t r = 0; r < parts.size(); ++r) {
    auto from = parts[r].begin();
    for (std::size_t k = 0; k < rows_[r].size(); ++k)
      if (owned_there_[r][k]) {
        std::copy_n(from, width, block.begin() + std::ptrdiff_t(std::size_t(rows_[r][k]) * width));
        from += std::ptrdiff_t(width);
      }
  }
  return block;
}

std::vector<double> GlobalOrder::from_block(std::span<const double> block, std::size_t width) const {
  std::vector<std::vector<double>> parts(rows_.size());
  for (std::size_t r = 0; r < parts.size(); ++r)
    for (const Index row : rows_[r]) {
      const auto from = block.begin() + std::ptrdiff_t(std::size_t(row) * width);
      parts[r].insert(parts[r].end(), from, from + std::ptrdiff_t(width));
    }
  parts = all_to_all(comm_, parts);
  std::vector<double> values(n_local_ * width);
  for (std::size_t r = 0; r < parts.size(); ++r)
    for (std::size_t k = 0; k < entries_[r].size(); ++k)
      std::copy_n(parts[r].begin() + std::ptrdiff_t(k * width), width,
                  values.begin() + std::ptrdiff_t(std::size_t(entries_[r][k]) * width));
  return values;
}

}  // namespace couplet::parallel
