// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <mpi.h>

#include <Eigen/Core>
#include <deque>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "coupler/acceleration/accelerator.hpp"

namespace couplet::coupler {

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

  void visit(io::Archive& archive, const std::string& name, const parallel::GlobalOrder& order);

 private:
  MPI_Comm comm_;
  std::vector<std::vector<double>> q_;
  Eigen::MatrixXd r_;
};

/// Quasi-Newton method with the inverse Jacobian from a least-squares problem over this and earlier steps
/// (IQN-ILS) [Degroote, Bathe, Vierendeels 2009; filter: Haelterman et al. 2016]:
///   x^{k+1} = H(x^k) + W c,  c = argmin |r^k + V c|.
/// The columns of V = QR and W are differences of r and H(x) between two passes of one step, newest first.
/// Components of r outside the columns use the plain iteration. Without columns: x += omega r. If an update
/// that used pairs of earlier steps made the residual ten times larger, those pairs describe another map and
/// are discarded; those of this step stay. An update that is not finite is replaced by a relaxation, and all
/// pairs are discarded.
class QuasiNewton final : public Accelerator {
 public:
  QuasiNewton(const AccelerationParameters& parameters, MPI_Comm comm);
  void start_step() override;
  Iterate next(Iterate x, const Iterate& image) override;
  void accept(const Iterate& x, const Iterate& image) override;
  void map_changed() override { last_.reset(); }
  double relaxation() const override { return share_; }
  int columns() const override { return qr_.columns(); }
  long resets() const override { return resets_; }
  void visit(io::Archive& archive, const IterateOrder& order) override;

 private:
  struct Pair {
    std::vector<double> residual;
    Iterate image;
  };
  /// Adds the difference to the previous pass of this step, if there is one and the two differ.
  void learn(const Iterate& x, const Iterate& image);
  void add(Pair pair);
  bool uses_earlier_steps() const { return !step_of_.empty() && step_of_.back() != step_; }
  void forget_all();
  void drop_oldest();
  bool is_finite(const Iterate& x) const;

  AccelerationParameters parameters_;
  MPI_Comm comm_;
  std::optional<Pair> last_;  // last pass of this step
  double share_;              // of the residual in the last update
  bool open_ = false;         // the step is not accepted yet
  long resets_ = 0;
  GrowingQr qr_;                // of V
  std::deque<Iterate> images_;  // columns of W, with their dependents
  std::deque<double> step_of_;  // number of the step, per column
  double step_ = 0;
};

}  // namespace couplet::coupler
