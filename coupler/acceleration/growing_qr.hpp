// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <mpi.h>

#include <Eigen/Core>
#include <span>
#include <string>
#include <vector>

namespace couplet::io {
class CheckpointReader;
class CheckpointWriter;
}  // namespace couplet::io

namespace couplet::coupler {

/// A checkpoint holds no more of them.
inline constexpr std::size_t most_columns = 10000;

/// A = Q R of a tall matrix whose rows are distributed and whose columns come and go: new ones join at the
/// front, any may leave. Gram-Schmidt twice for a new column, Givens rotations for the rest [Golub, Van Loan
/// 2013, 6.5]: 10 m flops a row for each change of m columns, and two sums over the ranks.
class GrowingQr {
 public:
  explicit GrowingQr(MPI_Comm comm) : comm_(comm) {}
  int columns() const { return static_cast<int>(q_.size()); }
  /// A becomes [v A]. A column that depends on the others (or is zero) leaves a diagonal of zero in R: drop()
  /// must be called before the next use.
  void push_front(std::vector<double> v);
  void erase(int column);
  void clear();
  /// Erases, front to back, each column of which less than `limit` is left beside those before it:
  /// |R_jj| < limit |a_j| ("QR2"). Returns their positions in the order in which they left.
  std::vector<int> drop(double limit);
  /// c that makes |r + A c| smallest.
  Eigen::VectorXd minimise(std::span<const double> r) const;
  /// Q^T r, over all ranks; r -= Q t.
  Eigen::VectorXd along(std::span<const double> r) const;
  void subtract(const Eigen::VectorXd& t, std::span<double> r) const;
  Eigen::VectorXd back_substitute(const Eigen::VectorXd& t) const;

  void save(io::CheckpointWriter& file, const std::string& name, const parallel::GlobalOrder& order) const;
  void load(io::CheckpointReader& file, const std::string& name, const parallel::GlobalOrder& order);

 private:
  MPI_Comm comm_;
  std::vector<std::vector<double>> q_;
  Eigen::MatrixXd r_;
};

}  // namespace couplet::coupler
