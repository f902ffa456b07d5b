// SPDX-License-Identifier: Apache-2.0
#include "common/linalg/multigrid/coloured_multigrid.hpp"

#include <bit>
#include <cstdint>
#include <utility>

#include "common/base/processor_clones.hpp"

namespace couplet::linalg {
namespace {

using Floats = Eight<float>;

constexpr std::size_t most_coloured = 2;  // levels; those below them are small

/// The first colour that no neighbour has, row by row; `n`: how many there are.
std::vector<std::uint8_t> colours_of(const ColouredMultigrid::Rows& rows, int& n) {
  std::vector<std::uint8_t> colour(rows.size(), 255);
  n = 0;
  for (Index i = 0; i < rows.size(); ++i) {
    std::uint64_t taken = 0;
    for (Index e = rows.offset[i]; e < rows.offset[i + 1]; ++e)
      if (const Index j = rows.index[e]; j < i) taken |= std::uint64_t(1) << colour[j];
    // More than 63 colours: a cell that many cells touch; sweeps leave out what it and others of the last colour have in common.
    colour[i] = static_cast<std::uint8_t>(std::min(std::countr_one(taken), 63));
    n = std::max(n, colour[i] + 1);
  }
  return colour;
}

}  // namespace

ColouredLevel::ColouredLevel(const Level& level) : map_(level.map), n_(level.a.size()) {
  make_slices(level.a, find_places(level.a));
  inverse_.assign(padded_, 0.0F);
  for (Index i = 0; i < n_; ++i) inverse_[place_[i]] = level.inverse_diagonal[i];
  p_offset_.assign(1, 0);
  for (Index k = 0; k < padded_; ++k) {
    const Index i = row_[k];
    if (place_[i] == k)
      for (Index e = level.p_offset[i]; e < level.p_offset[i + 1]; ++e) {
        p_index_.push_back(level.p_index[e]);
        p_value_.push_back(level.p_value[e]);
      }
    p_offset_.push_back(static_cast<Index>(p_index_.size()));
  }
  b_.assign(with_room(padded_), 0.0F);
  x_.assign(with_room(padded_ + place_.size() - n_), 0.0F);
  if (map_) ghosts_.assign(place_.size(), 0.0F);
}

/// Gives the colours.
std::vector<std::uint8_t> ColouredLevel::find_places(const AggregationMultigrid<float>::Rows& rows) {
  int n_colours = 0;
  std::vector<std::uint8_t> colour = colours_of(rows, n_colours);
  const Index local = map_ ? map_->n_local() : n_;
  place_.resize(local);
  for (int c = 0; c < n_colours; ++c) {
    for (Index i = 0; i < n_; ++i)
      if (colour[i] == c) place_[i] = padded_++, row_.push_back(i);
    padded_ = (padded_ + slice_width - 1) / slice_width * slice_width;
    row_.resize(padded_, -1);
  }
  for (Index g = n_; g < local; ++g) place_[g] = padded_ + g - n_;
  return colour;
}

void ColouredLevel::make_slices(const AggregationMultigrid<float>::Rows& rows,
                                const std::vector<std::uint8_t>& colour) {
  const Index room = static_cast<Index>(with_room(padded_ + Index(place_.size()) - n_));
  std::vector<Slices<float>::Entry> before, behind;
  for (Index first = 0; first < padded_; first += slice_width) {
    before.clear(), behind.clear();
    for (Index k = first; k < first + slice_width; ++k) {
      if (row_[k] < 0) continue;
      for (Index e = rows.offset[row_[k]]; e < rows.offset[row_[k] + 1]; ++e) {
        const Index j = rows.index[e];
        if (j < n_ && colour[j] == colour[row_[k]]) continue;  // more than 63 colours
        (j < n_ && place_[j] < k ? before : behind).push_back({k, place_[j], e});
      }
    }
    for (auto [slices, entries] : {std::pair{&before_, &before}, std::pair{&behind_, &behind}})
      slices->add(first, *entries, room, [&](Index e, std::size_t at) { slices->value[at] = rows.value[e]; });
  }
  for (Index& row : row_) row = std::max(row, 0);
}

void ColouredLevel::update_ghosts() {
  if (!map_) return;
  for (Index i = 0; i < n_; ++i) ghosts_[i] = x_[place_[i]];
  map_->update_ghosts(std::as_writable_bytes(std::span(ghosts_)), sizeof(float));
  std::copy(ghosts_.begin() + n_, ghosts_.end(), x_.begin() + padded_);
}

namespace {

/// x = inverse (b - sum of the slices times x), from the first slice on or from the last.
template <bool Up>
[[gnu::always_inline]] inline void sweep(const Slices<float>& before, const Slices<float>& behind,
                                         const float* inverse, const float* b, float* x) {
  const Index n = before.size();
  for (Index k = 0; k < n; ++k) {
    const Index s = Up ? n - 1 - k : k;
    const std::size_t at = std::size_t(s) * slice_width;
    Floats right, d, product{};
    before.multiply(s, x, product);
    if (Up) behind.multiply(s, x, product);
    load(b + at, right);
    load(inverse + at, d);
    store(Floats((right - product) * d), x + at);
  }
}
COUPLET_PROCESSOR_CLONES void down_pass(const Slices<float>& before, const Slices<float>& behind,
                                        const float* inverse, const float* b, float* x) {
  sweep<false>(before, behind, inverse, b, x);
}
COUPLET_PROCESSOR_CLONES void up_pass(const Slices<float>& before, const Slices<float>& behind,
                                      const float* inverse, const float* b, float* x) {
  sweep<true>(before, behind, inverse, b, x);
}

COUPLET_PROCESSOR_CLONES void restrict_pass(const Slices<float>& behind, const float* x, const Index* offset,
                                            const Index* index, const float* value, float* coarse) {
  for (Index s = 0, n = behind.size(); s < n; ++s) {
    if (behind.start[s] == behind.start[s + 1]) continue;
    Floats product{};
    behind.multiply(s, x, product);
    float residual[slice_width];
    store(product, residual);
    for (Index r = 0; r < slice_width; ++r) {
      const Index place = s * slice_width + r;
      for (Index k = offset[place]; k < offset[place + 1]; ++k) coarse[index[k]] -= value[k] * residual[r];
    }
  }
}

COUPLET_PROCESSOR_CLONES void prolong_pass(const Slices<float>& behind, bool all, const Index* offset,
                                           const Index* index, const float* value, const float* coarse,
                                           float* x) {
  for (Index s = 0, n = behind.size(); s < n; ++s) {
    if (behind.start[s] == behind.start[s + 1] && !all) continue;
    for (Index i = s * slice_width; i < (s + 1) * slice_width; ++i) {
      float sum = x[i];
      for (Index k = offset[i]; k < offset[i + 1]; ++k) sum += value[k] * coarse[index[k]];
      x[i] = sum;
    }
  }
}

}  // namespace

template <class Number>
void ColouredLevel::smooth_down(const Number* b, double scale) {
  for (Index k = 0; k < padded_; ++k) b_[k] = static_cast<float>(scale * b[row_[k]]);
  down_pass(before_, behind_, inverse_.data(), b_.data(), x_.data());
}

void ColouredLevel::restrict_residual(std::vector<float>& coarse) const {
  std::fill(coarse.begin(), coarse.end(), 0.0F);
  restrict_pass(behind_, x_.data(), p_offset_.data(), p_index_.data(), p_value_.data(), coarse.data());
}

void ColouredLevel::prolong(const std::vector<float>& coarse) {
  prolong_pass(behind_, map_ != nullptr, p_offset_.data(), p_index_.data(), p_value_.data(), coarse.data(),
               x_.data());
}

template <class Number>
void ColouredLevel::smooth_up(Number* x, double size) {
  up_pass(before_, behind_, inverse_.data(), b_.data(), x_.data());
  for (Index i = 0; i < n_; ++i) x[i] = static_cast<Number>(size * x_[place_[i]]);
}

ColouredMultigrid::ColouredMultigrid(Rows rows, const Options& options) : levels_(std::move(rows), options) {
  const std::size_t n = std::min(most_coloured, std::size_t(levels_.n_levels() - 1));
  for (std::size_t l = 0; l < n; ++l) {
    coloured_.emplace_back(levels_.level(l));
    levels_.level(l).forget_matrix();
  }
}

void ColouredMultigrid::apply(std::span<const double> b, std::span<double> x, double size) {
  if (coloured_.empty()) return levels_.apply(b, x, 1);
  for (std::size_t l = 0; l < coloured_.size(); ++l) {
    ColouredLevel& level = coloured_[l];
    if (l == 0)
      level.smooth_down(b.data(), 1 / size);
    else
      level.smooth_down(levels_.level(l).b.data(), 1);
    level.update_ghosts();
    level.restrict_residual(levels_.level(l + 1).b);
  }
  levels_.cycle(coloured_.size());
  for (std::size_t l = coloured_.size(); l-- > 0;) {
    ColouredLevel& level = coloured_[l];
    level.prolong(levels_.level(l + 1).x);
    level.update_ghosts();
    if (l == 0)
      level.smooth_up(x.data(), size);
    else
      level.smooth_up(levels_.level(l).x.data(), 1);
  }
}

}  // namespace couplet::linalg
