// SPDX-License-Identifier: Apache-2.0
#include "coupler/exchange/transfer.hpp"

#include <algorithm>
#include <limits>

#include "common/parallel/collective.hpp"
#include "coupler/exchange/side.hpp"

namespace couplet::coupler {

namespace {

/// Sums equal entries, which are sorted by target and source.
void add_up(std::vector<Transfer::Entry>& entries) {
  std::size_t kept = 0;
  for (const auto& e : entries)
    if (kept > 0 && entries[kept - 1].target == e.target && entries[kept - 1].source == e.source)
      entries[kept - 1].weight += e.weight;
    else
      entries[kept++] = e;
  entries.resize(kept);
}

/// Sorts entries of targets from `first` on by counting, because a rank's targets are contiguous.
void sort_rows(GlobalIndex first, GlobalIndex end, std::vector<Transfer::Entry>& entries) {
  if (std::ranges::is_sorted(entries, by_row)) return;
  std::vector<std::size_t> at(std::size_t(end - first) + 1, 0);
  for (const auto& e : entries) ++at[std::size_t(e.target - first) + 1];
  for (std::size_t t = 1; t < at.size(); ++t) at[t] += at[t - 1];
  std::vector<Transfer::Entry> sorted(entries.size());
  for (const auto& e : entries) sorted[at[std::size_t(e.target - first)]++] = e;
  entries = std::move(sorted);
  // at[t] is now the end of row t.
  for (std::size_t t = 0, begin = 0; t + 1 < at.size(); begin = at[t++]) {
    const auto row = std::ranges::subrange(entries.begin() + std::ptrdiff_t(begin),
                                           entries.begin() + std::ptrdiff_t(at[t]));
    if (!std::ranges::is_sorted(row, by_row)) std::ranges::stable_sort(row, by_row);
  }
}

/// Product for N components, known at compile time, or 0.
template <std::size_t N>
void multiply(const std::vector<std::size_t>& first, const std::vector<Index>& column,
              const std::vector<double>& weight, const double* from, std::size_t components, double* to) {
  const std::size_t n = N > 0 ? N : components;
  for (std::size_t t = 0; t + 1 < first.size(); ++t)
    for (std::size_t e = first[t]; e < first[t + 1]; ++e)
      for (std::size_t c = 0; c < n; ++c) to[t * n + c] += weight[e] * from[std::size_t(column[e]) * n + c];
}

using Entry = Transfer::Entry;
using Entries = std::vector<Entry>;

/// Sums one row of the product by source.
class RowSums {
 public:
  /// Sources from `first` to `end` - 1.
  RowSums(GlobalIndex first, GlobalIndex end) : first_(first), place_(std::size_t(end - first), -1) {}
  void add(GlobalIndex source, double value) {
    Index& place = place_[std::size_t(source - first_)];
    if (place < 0)
      place = Index(sums_.size()), sums_.push_back({0, source, value});
    else
      sums_[std::size_t(place)].weight += value;
  }
  /// Returns the sums by ascending source and clears them.
  void take(GlobalIndex target, Entries& to) {
    std::ranges::sort(sums_, {}, &Entry::source);
    for (const Entry& e : sums_)
      to.push_back({target, e.source, e.weight}), place_[std::size_t(e.source - first_)] = -1;
    sums_.clear();
  }

 private:
  GlobalIndex first_;
  std::vector<Index> place_;  // of a source among the sums; -1 if it has none
  Entries sums_;
};

/// Rows of a map at some places: those of this rank, and copies from other ranks.
class MapRows {
 public:
  /// `own`: this rank's entries by owner, in order. `needed`: positions on other ranks, ascending.
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
    struct RowReply {
      Entry entry;
      int to;
    };
    std::vector<RowReply> answers;
    for (const Question& q : to_owners(
             comm, std::move(ask), [&](const Question& q) { return coupling::owner_of(starts, q.place); }))
      for (const Entry& e : row(q.place)) answers.push_back({e, q.asks});
    for (const RowReply& a : to_owners(comm, std::move(answers), [](const RowReply& a) { return a.to; }))
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
  /// The first source and one beyond the last.
  std::pair<GlobalIndex, GlobalIndex> sources() const {
    GlobalIndex low = std::numeric_limits<GlobalIndex>::max(), high = -1;
    for (const auto* entries : {&own_, &copies_})
      for (const Entry& e : *entries) low = std::min(low, e.source), high = std::max(high, e.source);
    return high < 0 ? std::pair{GlobalIndex(0), GlobalIndex(0)} : std::pair{low, high + 1};
  }

 private:
  GlobalIndex first_, end_;
  const Entries& own_;
  std::vector<std::size_t> at_;
  Entries copies_;  // ascending: they come rank by rank, each in the order of the questions
};

bool all_there(const coupling::Starts& starts, std::size_t rank, const Entries& entries) {
  return std::ranges::all_of(
      entries, [&](const Entry& e) { return e.target >= starts[rank] && e.target < starts[rank + 1]; });
}

}  // namespace

std::vector<Transfer::Entry> by_owner(MPI_Comm comm, const coupling::Starts& targets,
                                      std::vector<Transfer::Entry> entries) {
  entries = to_owners(comm, std::move(entries),
                      [&](const Transfer::Entry& e) { return coupling::owner_of(targets, e.target); });
  const auto rank = std::size_t(parallel::comm_rank(comm));
  sort_rows(targets[rank], targets[rank + 1], entries);
  add_up(entries);
  return entries;
}

Transfer::Transfer(MPI_Comm comm, const coupling::Starts& targets, const coupling::Starts& sources,
                   std::vector<Entry> entries)
    : comm_(comm), alone_(parallel::comm_size(comm) == 1) {
  const auto rank = std::size_t(parallel::comm_rank(comm));
  entries = by_owner(comm, targets, std::move(entries));
  n_sources_ = std::size_t(sources[rank + 1] - sources[rank]);
  std::vector<GlobalIndex> foreign;
  for (const Entry& e : entries)
    if (e.source < sources[rank] || e.source >= sources[rank + 1]) foreign.push_back(e.source);
  std::ranges::sort(foreign);
  foreign.erase(std::unique(foreign.begin(), foreign.end()), foreign.end());
  const std::size_t n_targets = std::size_t(targets[rank + 1] - targets[rank]);
  first_.assign(n_targets + 1, 0);
  column_.reserve(entries.size()), weight_.reserve(entries.size());
  for (const Entry& e : entries) {
    ++first_[std::size_t(e.target - targets[rank]) + 1];
    const bool mine = e.source >= sources[rank] && e.source < sources[rank + 1];
    column_.push_back(mine ? Index(e.source - sources[rank])
                           : Index(n_sources_ + std::size_t(std::ranges::lower_bound(foreign, e.source) -
                                                            foreign.begin())));
    weight_.push_back(e.weight);
  }
  for (std::size_t t = 0; t < n_targets; ++t) first_[t + 1] += first_[t];
  same_ = alone_ && n_sources_ == n_targets && column_.size() == n_targets;
  for (std::size_t t = 0; same_ && t < n_targets; ++t)
    same_ = first_[t + 1] == t + 1 && std::size_t(column_[t]) == t && weight_[t] == 1;
  if (alone_) return;
  // Positions on other ranks are ascending, so they are grouped by rank.
  std::vector<std::vector<GlobalIndex>> wanted(std::size_t(parallel::comm_size(comm)));
  for (const GlobalIndex s : foreign) wanted[std::size_t(coupling::owner_of(sources, s))].push_back(s);
  for (const auto& list : wanted) take_.push_back(int(list.size()));
  for (const auto& list : parallel::all_to_all(comm, wanted)) {
    auto& mine = give_.emplace_back();
    for (const GlobalIndex s : list) mine.push_back(std::size_t(s - sources[rank]));
  }
}

std::vector<double> Transfer::fetch(std::span<const double> values, int components) const {
  const auto n = std::size_t(components);
  std::vector<double> all(values.begin(), values.end()), out;
  std::vector<int> out_counts, out_first, in_counts, in_first;
  for (const auto& list : give_) {
    out_first.push_back(int(out.size()));
    for (const std::size_t s : list)
      out.insert(out.end(), values.begin() + std::ptrdiff_t(s * n),
                 values.begin() + std::ptrdiff_t((s + 1) * n));
    out_counts.push_back(int(out.size()) - out_first.back());
  }
  int total = 0;
  for (const int count : take_) {
    in_first.push_back(total);
    in_counts.push_back(count * components);
    total += in_counts.back();
  }
  all.resize(n_sources_ * n + std::size_t(total));
  MPI_Alltoallv(out.data(), out_counts.data(), out_first.data(), MPI_DOUBLE, all.data() + n_sources_ * n,
                in_counts.data(), in_first.data(), MPI_DOUBLE, comm_);
  return all;
}

std::vector<double> Transfer::apply(std::span<const double> values, int components) const {
  if (same_) return {values.begin(), values.end()};
  const std::vector<double> fetched = alone_ ? std::vector<double>{} : fetch(values, components);
  const double* from = alone_ ? values.data() : fetched.data();
  const auto n = std::size_t(components);
  std::vector<double> result((first_.size() - 1) * n, 0.);
  const auto product = n == 1 ? multiply<1> : n == 2 ? multiply<2> : n == 3 ? multiply<3> : multiply<0>;
  product(first_, column_, weight_, from, n, result.data());
  return result;
}

std::vector<Transfer::Entry> transposed(std::vector<Transfer::Entry> entries) {
  for (auto& e : entries) std::swap(e.target, e.source);
  return entries;
}

Entries product(MPI_Comm comm, const coupling::Starts& between, const Entries& second, const Entries& first) {
  const auto rank = std::size_t(parallel::comm_rank(comm));
  const bool ready = all_there(between, rank, first) && std::ranges::is_sorted(first, by_row);
  const bool all_ready = !parallel::any(comm, !ready);
  const Entries moved = all_ready ? Entries{} : by_owner(comm, between, first);
  Entries sorted;
  if (!std::ranges::is_sorted(second, by_row)) sorted = second, std::ranges::stable_sort(sorted, by_row);
  const Entries& after = sorted.empty() ? second : sorted;
  std::vector<GlobalIndex> needed;
  for (const Entry& e : after)
    if (e.source < between[rank] || e.source >= between[rank + 1]) needed.push_back(e.source);
  std::ranges::sort(needed);
  needed.erase(std::unique(needed.begin(), needed.end()), needed.end());
  const MapRows rows(comm, between, all_ready ? first : moved, needed);
  Entries result;
  std::size_t most = 0;
  for (const Entry& e : after) most += rows.row(e.source).size();
  result.reserve(most / 2);  // neighboring rows have common sources
  const auto [first_source, end_source] = rows.sources();
  RowSums sums(first_source, end_source);
  for (std::size_t i = 0; i < after.size(); ++i) {
    for (const Entry& e : rows.row(after[i].source)) sums.add(e.source, after[i].weight * e.weight);
    if (i + 1 == after.size() || after[i + 1].target != after[i].target) sums.take(after[i].target, result);
  }
  return result;
}

}  // namespace couplet::coupler
