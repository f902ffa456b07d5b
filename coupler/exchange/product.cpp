// SPDX-License-Identifier: Apache-2.0
#include "coupler/exchange/product.hpp"

#include <algorithm>
#include <cstdint>

#include "common/parallel/collective.hpp"
#include "coupler/exchange/search.hpp"

namespace couplet::coupler {
namespace {

using Entry = Transfer::Entry;
using Entries = std::vector<Entry>;

/// Sums by source of one row of the product: an open table of places and values.
class RowSums {
 public:
  void add(GlobalIndex source, double value) {
    if (2 * (used_.size() + 1) > keys_.size()) grow();
    const std::size_t slot = slot_of(source);
    if (keys_[slot] == nothing) keys_[slot] = source, values_[slot] = 0, used_.push_back(source);
    values_[slot] += value;
  }
  /// Ascending by source; then the table is empty.
  void take(GlobalIndex target, Entries& to) {
    std::ranges::sort(used_);
    for (const GlobalIndex source : used_) to.push_back({target, source, values_[slot_of(source)]});
    std::ranges::fill(keys_, nothing);
    used_.clear();
  }

 private:
  static constexpr GlobalIndex nothing = -1;
  /// Its own, or the empty one where it belongs.
  std::size_t slot_of(GlobalIndex source) const {
    const std::size_t mask = keys_.size() - 1;
    std::size_t slot = std::size_t(std::uint64_t(source) * 0x9E3779B97F4A7C15u >> 32) & mask;
    while (keys_[slot] != nothing && keys_[slot] != source) slot = (slot + 1) & mask;
    return slot;
  }
  void grow() {
    std::vector<GlobalIndex> keys(2 * keys_.size(), nothing);
    std::vector<double> values(keys.size());
    keys_.swap(keys), values_.swap(values);
    for (std::size_t i = 0; i < keys.size(); ++i)
      if (keys[i] != nothing) {
        const std::size_t slot = slot_of(keys[i]);
        keys_[slot] = keys[i], values_[slot] = values[i];
      }
  }
  std::vector<GlobalIndex> keys_ = std::vector<GlobalIndex>(128, nothing), used_;
  std::vector<double> values_ = std::vector<double>(128);
};

/// The rows of a map at some places: those of this rank, and copies of others' that it needs.
class MapRows {
 public:
  /// `own`: by owner and in order; `needed`: places of others, ascending.
  MapRows(MPI_Comm comm, const coupling::Starts& starts, const Entries& own,
          const std::vector<GlobalIndex>& needed)
      : first_(starts[std::size_t(parallel::comm_rank(comm))]),
        end_(starts[std::size_t(parallel::comm_rank(comm)) + 1]),
        own_(own) {
    at_.assign(std::size_t(end_ - first_) + 1, 0);
    for (const Entry& e : own_) ++at_[std::size_t(e.target - first_) + 1];
    for (std::size_t t = 1; t < at_.size(); ++t) at_[t] += at_[t - 1];
    if (parallel::comm_size(comm) == 1) return;
    struct Question {
      GlobalIndex place;
      int asks;
    };
    std::vector<Question> ask;
    for (const GlobalIndex p : needed) ask.push_back({p, parallel::comm_rank(comm)});
    struct Answer {
      Entry entry;
      int to;
    };
    std::vector<Answer> answers;
    for (const Question& q : to_owners(
             comm, std::move(ask), [&](const Question& q) { return coupling::owner_of(starts, q.place); }))
      for (const Entry& e : row(q.place)) answers.push_back({e, q.asks});
    for (const Answer& a : to_owners(comm, std::move(answers), [](const Answer& a) { return a.to; }))
      copies_.push_back(a.entry);
  }
  std::span<const Entry> row(GlobalIndex place) const {
    if (place >= first_ && place < end_) {
      const std::size_t begin = at_[std::size_t(place - first_)], end = at_[std::size_t(place - first_) + 1];
      return {own_.data() + begin, end - begin};
    }
    const auto found = std::ranges::equal_range(copies_, place, {}, &Entry::target);
    return {found.data(), found.size()};
  }

 private:
  GlobalIndex first_, end_;
  const Entries& own_;
  std::vector<std::size_t> at_;
  Entries copies_;  // ascending: they come rank by rank, each in the order of the questions
};

bool all_there(const coupling::Starts& starts, int rank, const Entries& entries) {
  return std::ranges::all_of(entries, [&](const Entry& e) {
    return e.target >= starts[std::size_t(rank)] && e.target < starts[std::size_t(rank) + 1];
  });
}

}  // namespace

Entries product(MPI_Comm comm, const coupling::Starts& between, const Entries& second, const Entries& first) {
  const int rank = parallel::comm_rank(comm);
  const bool ready = all_there(between, rank, first) && std::ranges::is_sorted(first, by_row);
  const bool all_ready = !parallel::any(comm, !ready);
  const Entries moved = all_ready ? Entries{} : by_owner(comm, between, first);
  Entries sorted;
  if (!std::ranges::is_sorted(second, by_row)) sorted = second, std::ranges::stable_sort(sorted, by_row);
  const Entries& after = sorted.empty() ? second : sorted;
  std::vector<GlobalIndex> needed;
  for (const Entry& e : after)
    if (coupling::owner_of(between, e.source) != rank) needed.push_back(e.source);
  std::ranges::sort(needed);
  needed.erase(std::unique(needed.begin(), needed.end()), needed.end());
  const MapRows rows(comm, between, all_ready ? first : moved, needed);
  Entries result;
  result.reserve(after.size() + after.size() / 2);
  RowSums sums;
  for (std::size_t i = 0; i < after.size(); ++i) {
    for (const Entry& e : rows.row(after[i].source)) sums.add(e.source, after[i].weight * e.weight);
    if (i + 1 == after.size() || after[i + 1].target != after[i].target) sums.take(after[i].target, result);
  }
  return result;
}

}  // namespace couplet::coupler
