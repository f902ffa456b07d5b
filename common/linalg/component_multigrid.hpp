// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Cholesky>
#include <cstdint>
#include <span>
#include <vector>

#include "common/base/types.hpp"

namespace couplet {

/// One smoothed-aggregation V-cycle for up to four scalar M-matrices that share one graph (the components of
/// a vector field), all of them at once: a preconditioner. Single precision, four components in one register:
/// a cycle moves a fifth of what four separate hierarchies in double precision would.
///
/// Each rank has its own rows (couplings to other ranks are left out: block Jacobi).
class ComponentMultigrid {
 public:
  static constexpr int lanes = 4;
  using Lanes [[gnu::vector_size(16)]] = float;

  /// Symmetric rows without their diagonals: neighbours `index`, `value` = a_ij <= 0.
  struct Rows {
    std::vector<Index> offset{0}, index;
    std::vector<Lanes> value;
    std::vector<Lanes> diagonal;  ///< positive, in unused lanes too
    Index size() const { return static_cast<Index>(offset.size()) - 1; }
  };

  /// `coarse_factor`: of the correction by each coarser level; 1 where the rows are those of the operator itself.
  explicit ComponentMultigrid(Rows rows, float coarse_factor = 1);

  /// x = V(b) with `components` values a row.
  void apply(std::span<const double> b, std::span<double> x, int components);
  int n_levels() const { return static_cast<int>(levels_.size()); }

 private:
  struct Level {
    Rows a;
    std::vector<Index> middle;  // of each row: its first neighbour with a larger number
    std::vector<Lanes> inverse_diagonal;
    std::vector<Index> p_offset, p_index;  // prolongation to this level from the next
    std::vector<Lanes> p_value;
    std::vector<Lanes> x, b;
  };
  static void prolong(Level& fine, const std::vector<Index>& of, const std::vector<std::uint8_t>& is_strong);
  static Rows galerkin(const Level& fine, Index n_coarse);
  void add_level(Rows rows);
  void factor_coarsest();
  void solve_coarsest(Level& level) const;
  static void smooth_forward(Level& level);
  void restrict_residual(const Level& fine, std::vector<Lanes>& coarse) const;
  static void smooth_backward(Level& level);
  void cycle();

  float coarse_factor_;
  std::vector<Level> levels_;
  std::vector<Eigen::LLT<Eigen::MatrixXd>> coarsest_;  // one a component
};

}  // namespace couplet
