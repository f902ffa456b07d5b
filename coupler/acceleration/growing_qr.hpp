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

/// Maximum number of columns in a checkpoint.
inline constexpr std::size_t most_columns = 10000;

/// QR decomposition of a tall matrix with distributed rows whose columns change: new ones are added at the
/// front, any may be removed. Uses Gram-Schmidt twice for a new column and Givens rotations for the rest
/// [Golub, Van Loan 2013, 6.5]. A change of m columns costs 10 m flops per row and two sums over the ranks.
class GrowingQr {
 public:
  explicit GrowingQr(MPI_Comm comm) : comm_(comm) {}
  int columns() const { return static_cast<int>(q_.size()); }
  /// Changes A to [v A]. A linearly dependent (or zero) column gives a zero diagonal in R; call drop() before
  /// the next use.
  void push_front(std::vector<double> v);
  void erase(int column);
  /// Erases, front to back, each column with |R_jj| < limit |a_j|, nearly dependent on those before it
  /// ("QR2"). Returns their positions in the order of removal.
  std::vector<int> drop(double limit);
  /// Returns c that minimizes |r + A c|.
  Eigen::VectorXd minimise(std::span<const double> r) const;

  void save(io::CheckpointWriter& file, const std::string& name, const parallel::GlobalOrder& order) const;
  void load(io::CheckpointReader& file, const std::string& name, const parallel::GlobalOrder& order);

 private:
  MPI_Comm comm_;
  std::vector<std::vector<double>> q_;
  Eigen::MatrixXd r_;
};

}  // namespace couplet::coupler
