// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "common/linalg/lanes/slices.hpp"
#include "common/linalg/multigrid/component_multigrid.hpp"

namespace couplet::linalg {

/// A level of a multigrid hierarchy whose sweeps go colour by colour: rows of a colour are no neighbours, so that eight of them are done at
/// once, and on hexahedra, which have two colours, a sweep from x = 0 leaves a residual in the rows of one colour only. Each rank has
/// its own colours.
class ColouredLevel {
 public:
  using Level = AggregationMultigrid<float>::Level;
  /// Of a level that is not the coarsest.
  explicit ColouredLevel(const Level& level);
  /// x = (D + L)^-1 scale b, from x = 0.
  template <class Number>
  void smooth_down(const Number* b, double scale);
  /// coarse = P^T (b - A x) = - P^T U x after smooth_down().
  void restrict_residual(std::vector<float>& coarse) const;
  /// x += P coarse; rows that the next sweep makes anew without looking at them are left out.
  void prolong(const std::vector<float>& coarse);
  /// One sweep from the last colour to the first, then x times `size` by row.
  template <class Number>
  void smooth_up(Number* x, double size);
  /// Collective.
  void update_ghosts();

 private:
  std::vector<std::uint8_t> find_places(const AggregationMultigrid<float>::Rows& rows);
  void make_slices(const AggregationMultigrid<float>::Rows& rows, const std::vector<std::uint8_t>& colour);
  const parallel::IndexMap* map_;  // null: no ghosts
  Index n_, padded_ = 0;           // rows; places of rows, ghosts come behind
  std::vector<Index> place_;       // of each row and ghost
  std::vector<Index> row_;         // of each place, 0 of those that only fill up
  Slices<float> before_, behind_;  // neighbours of colours before its own; behind it, ghosts among them
  std::vector<float> inverse_, b_, x_, ghosts_;
  std::vector<Index> p_offset_, p_index_;  // by place
  std::vector<float> p_value_;
};

/// The V-cycle of AggregationMultigrid for one matrix, the largest levels smoothed colour by colour. Collective.
class ColouredMultigrid {
 public:
  using Rows = AggregationMultigrid<float>::Rows;
  using Options = AggregationMultigrid<float>::Options;
  ColouredMultigrid(Rows rows, const Options& options);
  /// x = V(b); `size`: of b, above 0, by which single precision holds its shape.
  void apply(std::span<const double> b, std::span<double> x, double size);

 private:
  AggregationMultigrid<float> levels_;
  std::vector<ColouredLevel> coloured_;  // the first of them
};

}  // namespace couplet::linalg
