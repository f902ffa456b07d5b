// SPDX-License-Identifier: Apache-2.0
// Aggregates, prolongation and Galerkin products of a multigrid hierarchy.
#include <algorithm>
#include <cmath>

#include "common/linalg/component_multigrid.hpp"
#include "common/parallel/collective.hpp"

namespace couplet::linalg {
namespace {

constexpr Index largest_coarsest = 60;
// A neighbor is strong if |a_ij| is at least this fraction of the largest in either row.
constexpr float strong = 0.5F;
// Damping of the prolongation smoother: 4/3 over the largest eigenvalue of D^-1 A, which is below 2.
constexpr float omega = 0.66F;

template <class Number>
float total(const Number& v) {
  float sum = 0;
  for (int l = 0; l < AggregationMultigrid<Number>::lanes; ++l) sum += lane(v, l);
  return sum;
}

/// Flags strong entries. Those of other ranks are never strong.
template <class Rows>
std::vector<std::uint8_t> strong_entries(const Rows& a) {
  std::vector<float> largest(a.size(), 0);
  for (Index i = 0; i < a.size(); ++i)
    for (Index e = a.offset[i]; e < a.offset[i + 1]; ++e)
      largest[i] = std::max(largest[i], -total(a.value[e]));
  std::vector<std::uint8_t> result(a.index.size());
  for (Index i = 0; i < a.size(); ++i)
    for (Index e = a.offset[i]; e < a.offset[i + 1]; ++e)
      result[e] =
          a.index[e] < a.size() && -total(a.value[e]) >= strong * std::min(largest[i], largest[a.index[e]]);
  return result;
}

/// Builds aggregates. A root takes its strong neighborhood if that is free; remaining rows join a neighbor.
/// Rows without entries have none (-1), because a sweep solves them.
template <class Rows>
std::vector<Index> aggregate(const Rows& a, const std::vector<std::uint8_t>& is_strong, Index& n_aggregates) {
  std::vector<Index> of(a.size(), -1);
  n_aggregates = 0;
  for (Index i = 0; i < a.size(); ++i) {
    if (of[i] >= 0 || a.offset[i] == a.offset[i + 1]) continue;
    bool free = true;
    for (Index e = a.offset[i]; e < a.offset[i + 1] && free; ++e) free = !is_strong[e] || of[a.index[e]] < 0;
    if (!free) continue;
    of[i] = n_aggregates;
    for (Index e = a.offset[i]; e < a.offset[i + 1]; ++e)
      if (is_strong[e]) of[a.index[e]] = n_aggregates;
    ++n_aggregates;
  }
  const std::vector<Index> roots = of;
  for (Index i = 0; i < a.size(); ++i) {
    if (of[i] >= 0 || a.offset[i] == a.offset[i + 1]) continue;
    float best = 0;
    for (Index e = a.offset[i]; e < a.offset[i + 1]; ++e)
      if (a.index[e] < a.size() && roots[a.index[e]] >= 0 && -total(a.value[e]) > best) {
        best = -total(a.value[e]);
        of[i] = roots[a.index[e]];
      }
    if (of[i] < 0) of[i] = n_aggregates++;
  }
  return of;
}

}  // namespace

/// Rows of P for the ghosts. Their columns are coarse rows of other ranks, which are ghosts there.
template <class Number>
struct AggregationMultigrid<Number>::GhostRows {
  std::vector<Index> offset{0}, index;
  std::vector<Lanes> value;
  std::unique_ptr<parallel::IndexMap> map;  // of the coarser level
};

/// Adds a level. Returns false if the last one is coarse enough or cannot be coarsened.
template <class Number>
bool AggregationMultigrid<Number>::coarsen() {
  Level& fine = levels_.back();
  const GlobalIndex rows = parallel::sum(comm_, GlobalIndex(fine.a.size()));
  if (rows <= largest_coarsest) return false;
  const std::vector<std::uint8_t> is_strong = strong_entries(fine.a);
  Index n_coarse = 0;
  const std::vector<Index> of = aggregate(fine.a, is_strong, n_coarse);
  if (parallel::sum(comm_, GlobalIndex(n_coarse)) * 4 > rows * 3) return false;
  prolong(fine, of, is_strong);
  GhostRows ghosts = rows_of_ghosts(fine, n_coarse);
  Rows coarse = galerkin(fine, n_coarse, ghosts);
  const parallel::IndexMap* map = ghosts.map.get();
  add_level(std::move(coarse), map, std::move(ghosts.map));
  return true;
}

// P = (I - omega D^-1 A) P_0 with weak neighbors lumped on the diagonal of A, which preserves constants.
template <class Number>
void AggregationMultigrid<Number>::prolong(Level& fine, const std::vector<Index>& of,
                                           const std::vector<std::uint8_t>& is_strong) {
  const Rows& a = fine.a;
  fine.p_offset.assign(1, 0);
  for (Index i = 0; i < a.size(); ++i) {
    const std::size_t first = fine.p_index.size();
    const auto add = [&](Index aggregate, const Lanes& value) {
      for (std::size_t k = first; k < fine.p_index.size(); ++k)
        if (fine.p_index[k] == aggregate) {
          fine.p_value[k] += value;
          return;
        }
      fine.p_index.push_back(aggregate);
      fine.p_value.push_back(value);
    };
    Lanes diagonal = a.diagonal[i];
    for (Index e = a.offset[i]; e < a.offset[i + 1]; ++e)
      if (!is_strong[e]) diagonal += a.value[e];
    // A row that is hardly coupled within its rank is not smoothed, so that its sum is 1, too.
    const auto is_held = diagonal > 1e-3F * a.diagonal[i];
    const Lanes none{}, one = none + 1.0F;
    if (of[i] >= 0) add(of[i], is_held ? one - omega : one);
    for (Index e = a.offset[i]; e < a.offset[i + 1]; ++e)
      if (is_strong[e]) add(of[a.index[e]], is_held ? -omega * a.value[e] / diagonal : none);
    fine.p_offset.push_back(static_cast<Index>(fine.p_index.size()));
  }
  fine.p_index.shrink_to_fit();
  fine.p_value.shrink_to_fit();
}

template <class Number>
typename AggregationMultigrid<Number>::GhostRows AggregationMultigrid<Number>::rows_of_ghosts(
    const Level& fine, Index n_coarse) const {
  GhostRows ghosts;
  if (!fine.map) return ghosts;
  struct Entry {
    GlobalIndex column;
    float value[lanes];
  };
  const Index n = fine.a.size(), n_local = fine.map->n_local();
  const GlobalIndex first = parallel::exclusive_scan(comm_, n_coarse);
  Index most = 0;
  for (Index i = 0; i < n; ++i) most = std::max(most, fine.p_offset[i + 1] - fine.p_offset[i]);
  most = static_cast<Index>(parallel::max(comm_, double(most)));
  std::vector<std::vector<Entry>> of_ghost(std::size_t(n_local - n));
  // Exchanges one entry per row at a time to save memory.
  std::vector<Entry> entries(n_local);
  for (Index k = 0; k < most; ++k) {
    for (Index i = 0; i < n; ++i) {
      entries[i] = {-1, {}};
      const Index at = fine.p_offset[i] + k;
      if (at >= fine.p_offset[i + 1]) continue;
      entries[i].column = first + fine.p_index[at];
      for (int l = 0; l < lanes; ++l) entries[i].value[l] = lane(fine.p_value[at], l);
    }
    fine.map->update_ghosts(std::as_writable_bytes(std::span(entries)), sizeof(Entry));
    for (Index i = n; i < n_local; ++i)
      if (entries[i].column >= 0) of_ghost[i - n].push_back(entries[i]);
  }
  std::vector<GlobalIndex> columns;
  for (const auto& row : of_ghost)
    for (const Entry& e : row) columns.push_back(e.column);
  std::ranges::sort(columns);
  columns.erase(std::ranges::unique(columns).begin(), columns.end());
  for (const auto& row : of_ghost) {
    for (const Entry& e : row) {
      const auto place = std::ranges::lower_bound(columns, e.column) - columns.begin();
      ghosts.index.push_back(n_coarse + static_cast<Index>(place));
      Lanes& value = ghosts.value.emplace_back();
      for (int l = 0; l < lanes; ++l) set_lane(value, l, e.value[l]);
    }
    ghosts.offset.push_back(static_cast<Index>(ghosts.index.size()));
  }
  const std::vector<GlobalIndex> firsts = parallel::all_gather(comm_, std::vector<GlobalIndex>{first});
  std::vector<int> owner;
  std::vector<Index> there;
  for (const GlobalIndex c : columns) {
    // Finds the last rank that begins at or before it. Ranks without rows begin where the next one does.
    owner.push_back(static_cast<int>(std::ranges::upper_bound(firsts, c) - firsts.begin()) - 1);
    there.push_back(static_cast<Index>(c - firsts[owner.back()]));
  }
  ghosts.map = std::make_unique<parallel::IndexMap>(comm_, n_coarse, owner, there);
  return ghosts;
}

// Computes P^T A P row by row.
template <class Number>
auto AggregationMultigrid<Number>::galerkin(const Level& fine, Index n_coarse, const GhostRows& ghosts)
    -> Rows {
  const Rows& a = fine.a;
  std::vector<Index> offset(n_coarse + 1, 0);
  for (const Index c : fine.p_index) ++offset[c + 1];
  for (Index c = 0; c < n_coarse; ++c) offset[c + 1] += offset[c];
  std::vector<Index> row(offset.back()), entry(offset.back()), next(offset.begin(), offset.end() - 1);
  for (Index i = 0; i < a.size(); ++i)
    for (Index k = fine.p_offset[i]; k < fine.p_offset[i + 1]; ++k) {
      const Index at = next[fine.p_index[k]]++;
      row[at] = i;
      entry[at] = k;
    }
  Rows coarse;
  std::vector<Index> place(ghosts.map ? ghosts.map->n_local() : n_coarse, -1);
  std::vector<std::pair<Index, Lanes>> sums;
  for (Index c = 0; c < n_coarse; ++c) {
    sums.clear();
    const auto spread_along = [&](const std::vector<Index>& p_offset, const std::vector<Index>& p_index,
                                  const std::vector<Lanes>& p_value, Index j, const Lanes& value) {
      for (Index k = p_offset[j]; k < p_offset[j + 1]; ++k) {
        const Index to = p_index[k];
        if (place[to] < 0) {
          place[to] = static_cast<Index>(sums.size());
          sums.push_back({to, Lanes{}});
        }
        sums[place[to]].second += value * p_value[k];
      }
    };
    const auto spread = [&](Index j, const Lanes& value) {
      if (j < a.size())
        spread_along(fine.p_offset, fine.p_index, fine.p_value, j, value);
      else
        spread_along(ghosts.offset, ghosts.index, ghosts.value, j - a.size(), value);
    };
    for (Index t = offset[c]; t < offset[c + 1]; ++t) {
      const Index i = row[t];
      const Lanes p = fine.p_value[entry[t]];
      spread(i, p * a.diagonal[i]);
      for (Index e = a.offset[i]; e < a.offset[i + 1]; ++e) spread(a.index[e], p * a.value[e]);
    }
    for (const auto& [to, value] : sums) place[to] = -1;
    std::sort(sums.begin(), sums.end(), [](const auto& x, const auto& y) { return x.first < y.first; });
    Lanes diagonal = Lanes{} + 1.0F;
    for (const auto& [to, value] : sums) {
      if (to == c) {
        diagonal = value;
        continue;
      }
      coarse.index.push_back(to);
      coarse.value.push_back(value);
    }
    coarse.diagonal.push_back(diagonal);
    coarse.offset.push_back(static_cast<Index>(coarse.index.size()));
  }
  coarse.index.shrink_to_fit();
  coarse.value.shrink_to_fit();
  return coarse;
}

template bool AggregationMultigrid<FourFloats>::coarsen();
template bool AggregationMultigrid<float>::coarsen();

}  // namespace couplet::linalg
