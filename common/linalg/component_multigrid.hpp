// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <mpi.h>
#include <Eigen/Cholesky>

#include <cstdint>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "common/base/types.hpp"
#include "common/parallel/gathered_rows.hpp"
#include "common/parallel/index_map.hpp"

namespace couplet::linalg {

using FourFloats [[gnu::vector_size(16)]] = float;
inline float lane(float v, int) { return v; }
inline float lane(const FourFloats& v, int l) { return v[l]; }
inline void set_lane(float& v, int, float value) { v = value; }
inline void set_lane(FourFloats& v, int l, float value) { v[l] = value; }

/// Smoothed-aggregation V-cycle in single precision as a preconditioner, for scalar M-matrices with one
/// graph. `Number` is float, or FourFloats for up to four matrices (the components of a vector field in one
/// register, which moves a fifth of the data of four separate hierarchies in double precision).
///
/// In parallel, aggregates and Gauss-Seidel sweeps are local to a rank. Residuals and Galerkin products
/// include couplings between ranks, and the coarsest level is gathered, so a cycle is almost as effective as
/// on one rank. It needs two messages per level. Plate B takes 0.34 of the time with ML (benchmarks/linalg).
template <class Number>
class AggregationMultigrid {
 public:
  static constexpr int lanes = sizeof(Number) / sizeof(float);
  using Lanes = Number;

  /// Symmetric rows without diagonals: `value` = a_ij <= 0 for the neighbors `index`. Neighbors on other
  /// ranks are the ghosts of Options::map.
  struct Rows {
    std::vector<Index> offset{0}, index;
    std::vector<Lanes> value;
    std::vector<Lanes> diagonal;  ///< positive, in unused lanes too
    Index size() const { return static_cast<Index>(offset.size()) - 1; }
  };

  struct MultigridOptions {
    /// Factor of the correction by each coarser level. 1 if the rows are those of the operator itself.
    float coarse_factor = 1;
    const parallel::IndexMap* map = nullptr;  ///< of the rows, by reference; nullptr if ranks are not coupled
    MPI_Comm comm = MPI_COMM_SELF;            ///< of the map
    /// All row sums are (nearly) zero, so the coarsest level gives no constant.
    bool closed = false;
  };
  /// Builds the hierarchy. Collective over the ranks of the map.
  explicit AggregationMultigrid(Rows rows) : AggregationMultigrid(std::move(rows), MultigridOptions{}) {}
  AggregationMultigrid(Rows rows, const MultigridOptions& options);

  /// Computes x = V(b) with `components` values per row. Collective.
  void apply(std::span<const double> b, std::span<double> x, int components);

 private:
  struct Level {
    Rows a;
    const parallel::IndexMap* map = nullptr;      // of x; nullptr without ghosts
    std::unique_ptr<parallel::IndexMap> own_map;  // of the coarser levels
    std::vector<Index> middle;  // of each row: its first neighbor with a larger number, including ghosts
    std::vector<Lanes> inverse_diagonal;
    std::vector<Index> p_offset, p_index;  // prolongation to this level from the next
    std::vector<Lanes> p_value;
    std::vector<Lanes> x, b;  // x includes ghosts
    void update_ghosts();
  };
  struct GhostRows;
  void cycle();
  static void prolong(Level& fine, const std::vector<Index>& of, const std::vector<std::uint8_t>& is_strong);
  GhostRows rows_of_ghosts(const Level& fine, Index n_coarse) const;
  static Rows galerkin(const Level& fine, Index n_coarse, const GhostRows& ghosts);
  bool coarsen();
  void add_level(Rows rows, const parallel::IndexMap* map, std::unique_ptr<parallel::IndexMap> own);
  void factor_coarsest();
  template <class Entries>
  void gather_coarsest(const Entries& entries);
  void solve_coarsest(Level& level);
  static void smooth_forward(Level& level);
  void restrict_residual(const Level& fine, std::vector<Lanes>& coarse) const;
  static void smooth_backward(Level& level);

  float coarse_factor_;
  bool closed_;
  MPI_Comm comm_;
  std::vector<Level> levels_;
  std::vector<Eigen::LLT<Eigen::MatrixXd>> coarsest_;  // one per component, of the rows of all ranks
  std::unique_ptr<AggregationMultigrid> gathered_;     // of these rows, where they are too many
  parallel::GatheredRows coarsest_rows_;
  std::vector<Lanes> whole_;  // right-hand side of all of them
};

using ComponentMultigrid = AggregationMultigrid<FourFloats>;

}  // namespace couplet::linalg
