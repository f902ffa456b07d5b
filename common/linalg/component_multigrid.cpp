// SPDX-License-Identifier: Apache-2.0
#include "common/linalg/component_multigrid.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "common/parallel/collective.hpp"

namespace couplet::linalg {

namespace {

constexpr GlobalIndex largest_coarsest = 60;
// The coarsest level has at least this many rows per rank, since a rank would send fewer to nearly all others.
constexpr GlobalIndex fewest_of_rank = 16;
// Largest coarsest level that is factorized.
constexpr GlobalIndex largest_dense = 1000;
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
  if (rows <= std::clamp(fewest_of_rank * parallel::comm_size(comm_), largest_coarsest, largest_dense))
    return false;
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
  struct GhostEntry {
    GlobalIndex column;
    float value[lanes];
  };
  const Index n = fine.a.size(), n_local = fine.map->n_local();
  const GlobalIndex first = parallel::exclusive_scan(comm_, n_coarse);
  Index most = 0;
  for (Index i = 0; i < n; ++i) most = std::max(most, fine.p_offset[i + 1] - fine.p_offset[i]);
  most = static_cast<Index>(parallel::max(comm_, double(most)));
  std::vector<std::vector<GhostEntry>> of_ghost(std::size_t(n_local - n));
  // Exchanges one entry per row at a time to save memory.
  std::vector<GhostEntry> entries(n_local);
  for (Index k = 0; k < most; ++k) {
    for (Index i = 0; i < n; ++i) {
      entries[i] = {-1, {}};
      const Index at = fine.p_offset[i] + k;
      if (at >= fine.p_offset[i + 1]) continue;
      entries[i].column = first + fine.p_index[at];
      for (int l = 0; l < lanes; ++l) entries[i].value[l] = lane(fine.p_value[at], l);
    }
    fine.map->update_ghosts(std::as_writable_bytes(std::span(entries)), sizeof(GhostEntry));
    for (Index i = n; i < n_local; ++i)
      if (entries[i].column >= 0) of_ghost[i - n].push_back(entries[i]);
  }
  std::vector<GlobalIndex> columns;
  for (const auto& row : of_ghost)
    for (const GhostEntry& e : row) columns.push_back(e.column);
  std::ranges::sort(columns);
  columns.erase(std::ranges::unique(columns).begin(), columns.end());
  for (const auto& row : of_ghost) {
    for (const GhostEntry& e : row) {
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

namespace {

constexpr std::size_t most_levels = 12;
/// Sorts neighbors by insertion, since rows are short and nearly sorted.
template <class Rows>
void sort_rows(Rows& a) {
  for (Index i = 0; i < a.size(); ++i)
    for (Index e = a.offset[i] + 1; e < a.offset[i + 1]; ++e)
      for (Index k = e; k > a.offset[i] && a.index[k] < a.index[k - 1]; --k) {
        std::swap(a.index[k], a.index[k - 1]);
        std::swap(a.value[k], a.value[k - 1]);
      }
}

}  // namespace

template <class Number>
AggregationMultigrid<Number>::AggregationMultigrid(Rows rows, const MultigridOptions& options)
    : coarse_factor_(options.coarse_factor),
      closed_(options.closed),
      comm_(options.map && parallel::comm_size(options.comm) > 1 ? options.comm : MPI_COMM_SELF) {
  add_level(std::move(rows), comm_ == MPI_COMM_SELF ? nullptr : options.map, nullptr);
  while (levels_.size() < most_levels && coarsen()) {
  }
  factor_coarsest();
  // The sweeps only use the inverse.
  for (Level& level : levels_) level.a.diagonal = std::vector<Lanes>();
}

template <class Number>
void AggregationMultigrid<Number>::add_level(Rows rows, const parallel::IndexMap* map,
                                             std::unique_ptr<parallel::IndexMap> own) {
  Level level;
  level.a = std::move(rows);
  level.map = map;
  level.own_map = std::move(own);
  const Index n = level.a.size();
  sort_rows(level.a);
  level.inverse_diagonal.resize(n);
  level.middle.resize(n);
  for (Index i = 0; i < n; ++i) {
    level.inverse_diagonal[i] = 1 / level.a.diagonal[i];
    const auto first = level.a.index.begin() + level.a.offset[i],
               last = level.a.index.begin() + level.a.offset[i + 1];
    level.middle[i] = static_cast<Index>(std::lower_bound(first, last, i) - level.a.index.begin());
  }
  level.b.assign(n, Lanes{});
  level.x.assign(map ? map->n_local() : n, Lanes{});
  levels_.push_back(std::move(level));
}

template <class Number>
void AggregationMultigrid<Number>::Level::update_ghosts() {
  if (map) map->update_ghosts(std::as_writable_bytes(std::span(x)), sizeof(Lanes));
}

template <class Number>
void AggregationMultigrid<Number>::factor_coarsest() {
  const Level& level = levels_.back();
  const Rows& a = level.a;
  const GlobalIndex n = parallel::sum(comm_, GlobalIndex(a.size()));
  if (n > largest_dense && comm_ == MPI_COMM_SELF)
    return;  // cannot be coarsened, so only smoothing is applied
  coarsest_rows_ = parallel::GatheredRows(comm_, a.size(), sizeof(Lanes));
  const Index first = coarsest_rows_.first();
  struct CoarseEntry {
    Index row, column;
    Lanes value;
  };
  std::vector<CoarseEntry> entries;
  for (Index i = 0; i < a.size(); ++i) {
    entries.push_back({first + i, first + i, a.diagonal[i]});
    for (Index e = a.offset[i]; e < a.offset[i + 1]; ++e)
      entries.push_back({first + i,
                         static_cast<Index>(level.map ? level.map->global(a.index[e]) : a.index[e]),
                         a.value[e]});
  }
  entries = parallel::all_gather(comm_, entries);
  if (n > largest_dense) return gather_coarsest(entries);
  whole_.resize(n);
  for (int l = 0; l < lanes; ++l) {
    Eigen::MatrixXd dense = Eigen::MatrixXd::Zero(n, n);
    for (const CoarseEntry& e : entries)  // a pure Neumann problem is singular
      dense(e.row, e.column) = lane(e.value, l) * (e.row == e.column ? 1 + 1e-5F : 1);
    coarsest_.emplace_back(dense);
  }
}

/// Every rank coarsens the rows of all ranks further, because aggregates no longer end at borders of ranks.
template <class Number>
template <class Entries>
void AggregationMultigrid<Number>::gather_coarsest(const Entries& entries) {
  Rows all;
  for (const auto& e : entries) {
    if (e.row == e.column) {
      all.diagonal.push_back(e.value);
      all.offset.push_back(all.offset.back());
    } else {
      all.index.push_back(e.column);
      all.value.push_back(e.value);
      ++all.offset.back();
    }
  }
  gathered_ = std::make_unique<AggregationMultigrid>(
      std::move(all), MultigridOptions{.coarse_factor = coarse_factor_, .closed = closed_});
}

template <class Number>
void AggregationMultigrid<Number>::solve_coarsest(Level& level) {
  if (coarsest_.empty() && !gathered_) {
    smooth_forward(level);
    level.update_ghosts();
    smooth_backward(level);
    return;
  }
  std::vector<Lanes>& right = gathered_ ? gathered_->levels_.front().b : whole_;
  coarsest_rows_.gather(level.b.data(), right.data());
  if (gathered_) {
    gathered_->cycle();
    std::copy_n(gathered_->levels_.front().x.begin() + coarsest_rows_.first(), level.a.size(),
                level.x.begin());
    return;
  }
  Eigen::VectorXd b(std::ssize(right));
  for (int l = 0; l < lanes; ++l) {
    for (std::size_t i = 0; i < right.size(); ++i) b[Index(i)] = lane(right[i], l);
    if (closed_) b.array() -= b.mean();
    b = coarsest_[l].solve(b).eval();
    if (closed_) b.array() -= b.mean();
    for (Index i = 0; i < level.a.size(); ++i)
      set_lane(level.x[i], l, static_cast<float>(b[coarsest_rows_.first() + i]));
  }
}

/// Computes x = (D + L)^-1 b.
template <class Number>
void AggregationMultigrid<Number>::smooth_forward(Level& level) {
  const Index *offset = level.a.offset.data(), *middle = level.middle.data(), *index = level.a.index.data();
  const Lanes *value = level.a.value.data(), *b = level.b.data(), *inverse = level.inverse_diagonal.data();
  Lanes* x = level.x.data();
  for (Index i = 0, n = level.a.size(); i < n; ++i) {
    Lanes sum = b[i];
    for (Index e = offset[i]; e < middle[i]; ++e) sum -= value[e] * x[index[e]];
    x[i] = sum * inverse[i];
  }
}

/// Computes P^T (b - A x) = - P^T U x after smooth_forward().
template <class Number>
void AggregationMultigrid<Number>::restrict_residual(const Level& fine, std::vector<Lanes>& coarse) const {
  const Index *offset = fine.a.offset.data(), *middle = fine.middle.data(), *index = fine.a.index.data();
  const Lanes *value = fine.a.value.data(), *x = fine.x.data();
  std::fill(coarse.begin(), coarse.end(), Lanes{});
  for (Index i = 0, n = fine.a.size(); i < n; ++i) {
    Lanes residual{};
    for (Index e = middle[i]; e < offset[i + 1]; ++e) residual -= value[e] * x[index[e]];
    residual *= coarse_factor_;
    for (Index k = fine.p_offset[i]; k < fine.p_offset[i + 1]; ++k)
      coarse[fine.p_index[k]] += fine.p_value[k] * residual;
  }
}

/// Performs one Gauss-Seidel sweep from the last row to the first.
template <class Number>
void AggregationMultigrid<Number>::smooth_backward(Level& level) {
  const Index *offset = level.a.offset.data(), *index = level.a.index.data();
  const Lanes *value = level.a.value.data(), *b = level.b.data(), *inverse = level.inverse_diagonal.data();
  Lanes* x = level.x.data();
  for (Index i = level.a.size() - 1; i >= 0; --i) {
    Lanes sum = b[i];
    for (Index e = offset[i]; e < offset[i + 1]; ++e) sum -= value[e] * x[index[e]];
    x[i] = sum * inverse[i];
  }
}

template <class Number>
void AggregationMultigrid<Number>::cycle() {
  const std::size_t last = levels_.size() - 1;
  for (std::size_t l = 0; l < last; ++l) {
    smooth_forward(levels_[l]);
    levels_[l].update_ghosts();
    restrict_residual(levels_[l], levels_[l + 1].b);
  }
  solve_coarsest(levels_[last]);
  for (std::size_t l = last; l-- > 0;) {
    Level &fine = levels_[l], &coarse = levels_[l + 1];
    for (Index i = 0; i < fine.a.size(); ++i)
      for (Index k = fine.p_offset[i]; k < fine.p_offset[i + 1]; ++k)
        fine.x[i] += fine.p_value[k] * coarse.x[fine.p_index[k]];
    fine.update_ghosts();
    smooth_backward(fine);
  }
}

template <class Number>
void AggregationMultigrid<Number>::apply(std::span<const double> b, std::span<double> x, int components) {
  Level& finest = levels_.front();
  // Scales b so that its magnitude does not exceed the range of single precision.
  double largest = 0;
  for (Index i = 0; i < finest.a.size() * components; ++i) largest = std::max(largest, std::abs(b[i]));
  if (comm_ != MPI_COMM_SELF) largest = parallel::max(comm_, largest);
  const double scale = largest > 0 ? 1 / largest : 0;
  for (Index i = 0; i < finest.a.size(); ++i) {
    Lanes value{};
    for (int c = 0; c < components; ++c)
      set_lane(value, c, static_cast<float>(scale * b[std::size_t(i) * components + c]));
    finest.b[i] = value;
  }
  cycle();
  for (Index i = 0; i < finest.a.size(); ++i)
    for (int c = 0; c < components; ++c) x[std::size_t(i) * components + c] = largest * lane(finest.x[i], c);
}

template class AggregationMultigrid<FourFloats>;
template class AggregationMultigrid<float>;

}  // namespace couplet::linalg
