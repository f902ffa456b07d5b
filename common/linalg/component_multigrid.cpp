// SPDX-License-Identifier: Apache-2.0
#include "common/linalg/component_multigrid.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "common/parallel/collective.hpp"

namespace couplet::linalg {
namespace {

constexpr std::size_t most_levels = 12;
// Largest coarsest level that is factorized if it cannot be coarsened further (on many ranks).
constexpr GlobalIndex largest_dense = 1000;
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
AggregationMultigrid<Number>::AggregationMultigrid(Rows rows, const Options& options)
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
  if (n > largest_dense) return;  // cannot be coarsened, so only smoothing is applied
  first_coarsest_ = static_cast<Index>(parallel::exclusive_scan(comm_, a.size()));
  struct Entry {
    Index row, column;
    float value[lanes];
  };
  std::vector<Entry> entries;
  const auto add = [&](Index i, GlobalIndex column, const Lanes& v) {
    entries.push_back({first_coarsest_ + i, static_cast<Index>(column), {}});
    for (int l = 0; l < lanes; ++l) entries.back().value[l] = lane(v, l);
  };
  for (Index i = 0; i < a.size(); ++i) {
    add(i, first_coarsest_ + i, a.diagonal[i] * (1 + 1e-5F));  // a pure Neumann problem is singular
    for (Index e = a.offset[i]; e < a.offset[i + 1]; ++e)
      add(i, level.map ? level.map->global(a.index[e]) : a.index[e], a.value[e]);
  }
  entries = parallel::all_gather(comm_, entries);
  for (int l = 0; l < lanes; ++l) {
    Eigen::MatrixXd dense = Eigen::MatrixXd::Zero(n, n);
    for (const Entry& e : entries) dense(e.row, e.column) = e.value[l];
    coarsest_.emplace_back(dense);
  }
}

template <class Number>
void AggregationMultigrid<Number>::solve_coarsest(Level& level) const {
  if (coarsest_.empty()) {
    smooth_forward(level);
    level.update_ghosts();
    smooth_backward(level);
    return;
  }
  const std::vector<Lanes> right = comm_ == MPI_COMM_SELF ? level.b : parallel::all_gather(comm_, level.b);
  Eigen::VectorXd b(std::ssize(right));
  for (int l = 0; l < lanes; ++l) {
    for (std::size_t i = 0; i < right.size(); ++i) b[Index(i)] = lane(right[i], l);
    if (closed_) b.array() -= b.mean();
    b = coarsest_[l].solve(b).eval();
    if (closed_) b.array() -= b.mean();
    for (Index i = 0; i < level.a.size(); ++i)
      set_lane(level.x[i], l, static_cast<float>(b[first_coarsest_ + i]));
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
