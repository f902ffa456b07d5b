// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <deque>
#include <optional>

#include "coupler/acceleration/accelerator.hpp"
#include "coupler/acceleration/growing_qr.hpp"

namespace couplet::coupler {

/// Differences of residuals, V = QR, and of images (with their riders), W, newest first.
class SecantPairs {
 public:
  explicit SecantPairs(MPI_Comm comm) : qr_(comm) {}
  int columns() const { return qr_.columns(); }
  void push_front(std::vector<double> residual, Iterate image);
  void erase(int column);
  /// Returns positions of columns removed because they depend on newer ones (see GrowingQr::drop).
  std::vector<int> drop(double limit);
  const GrowingQr& qr() const { return qr_; }
  /// Adds W c to `to`.
  void add(const Eigen::VectorXd& c, Iterate& to) const;
  void save(io::CheckpointWriter& file, const std::string& name, const IterateOrder& order) const;
  void load(io::CheckpointReader& file, const std::string& name, const IterateOrder& order);

 private:
  GrowingQr qr_;
  std::deque<Iterate> images_;
};

/// Common part of the quasi-Newton methods: differences between passes, the first update of a run, and the
/// guard against a bad update. If an update that used pairs of earlier steps made the residual ten times
/// larger, those pairs describe another map and are discarded; those of this step stay. An update that is not
/// finite is replaced by a relaxation, and all pairs are discarded.
class QuasiNewton : public Accelerator {
 public:
  QuasiNewton(const AccelerationParameters& parameters, MPI_Comm comm);
  void start_step() final;
  Iterate next(Iterate x, const Iterate& image) final;
  void accept(const Iterate& x, const Iterate& image) final;
  void map_changed() final { last_.reset(); }
  double relaxation() const final { return share_; }
  long resets() const final { return resets_; }

 protected:
  struct Pair {
    std::vector<double> residual;
    Iterate image;
  };
  const AccelerationParameters& parameters() const { return parameters_; }
  MPI_Comm comm() const { return comm_; }
  /// Residual of the last pass.
  const std::vector<double>& residual() const { return last_->residual; }

  /// Begins a step and removes pairs that are too old.
  virtual void begin_step() = 0;
  virtual void add(Pair pair) = 0;
  /// Computes next -= J r, where next is H(x) and there are pairs.
  virtual void correct(Iterate& next) const = 0;
  virtual bool uses_earlier_steps() const = 0;
  virtual void forget_earlier_steps() = 0;
  virtual void forget_all() = 0;

 private:
  /// Adds the difference to the previous pass of this step, if there is one and the two differ.
  void learn(const Iterate& x, const Iterate& image);
  bool is_finite(const Iterate& x) const;

  AccelerationParameters parameters_;
  MPI_Comm comm_;
  std::optional<Pair> last_;  // last pass of this step
  double share_;              // of the residual in the last update
  bool open_ = false;         // the step is not accepted yet
  long resets_ = 0;
};

/// Quasi-Newton method with the inverse Jacobian from a least-squares problem over this and earlier steps
/// (IQN-ILS) [Degroote, Bathe, Vierendeels 2009; filter: Haelterman et al. 2016]:
///   x^{k+1} = H(x^k) + W c,  c = argmin |r^k + V c|.
/// The columns of V and W are differences of r and H(x) between two passes of one step. Components of r
/// outside the columns use the plain iteration. Without columns: x += omega r.
class LeastSquaresNewton final : public QuasiNewton {
 public:
  LeastSquaresNewton(const AccelerationParameters& parameters, MPI_Comm comm)
      : QuasiNewton(parameters, comm), pairs_(comm) {}
  int columns() const override { return pairs_.columns(); }
  void save(io::CheckpointWriter& file, const IterateOrder& order) const override;
  void load(io::CheckpointReader& file, const IterateOrder& order) override;

 private:
  void begin_step() override;
  void add(Pair pair) override;
  void correct(Iterate& next) const override { pairs_.add(pairs_.qr().minimise(residual()), next); }
  bool uses_earlier_steps() const override { return !step_of_.empty() && step_of_.back() != step_; }
  void forget_earlier_steps() override;
  void forget_all() override;
  void drop_oldest();

  SecantPairs pairs_;
  std::deque<double> step_of_;  // number of the step, per column
  double step_ = 0;
};

/// Multi-vector quasi-Newton method (IQN-MVJ) [Bogaers et al. 2014], matrix-free. The differences of this
/// step correct the inverse Jacobian of earlier steps:
///   J = W V^+ + J_old (I - V V^+),  x^{k+1} = H(x^k) - J r^k,
/// applied as a product over the kept steps, newest first. The QR of each step stays unchanged: an update
/// costs 4 m flops per row for m columns, compared with 14 m for least squares.
class MultiVectorNewton final : public QuasiNewton {
 public:
  MultiVectorNewton(const AccelerationParameters& parameters, MPI_Comm comm)
      : QuasiNewton(parameters, comm) {}
  int columns() const override;
  void save(io::CheckpointWriter& file, const IterateOrder& order) const override;
  void load(io::CheckpointReader& file, const IterateOrder& order) override;

 private:
  void begin_step() override;
  void add(Pair pair) override;
  void correct(Iterate& next) const override;
  bool uses_earlier_steps() const override { return steps_.size() > 1; }
  void forget_earlier_steps() override { steps_.resize(1, SecantPairs(comm())); }
  void forget_all() override { steps_.assign(1, SecantPairs(comm())); }

  std::deque<SecantPairs> steps_;  // newest first, beginning with the current step
};

}  // namespace couplet::coupler
