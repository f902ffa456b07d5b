// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <deque>
#include <optional>

#include "coupler/acceleration/accelerator.hpp"
#include "coupler/acceleration/growing_qr.hpp"

namespace couplet::coupler {

/// Differences of residuals, V = QR, and those of the images (with their riders), W, newest first.
class SecantPairs {
 public:
  explicit SecantPairs(MPI_Comm comm) : qr_(comm) {}
  int columns() const { return qr_.columns(); }
  void push_front(std::vector<double> residual, Iterate image);
  void erase(int column);
  /// Positions of the columns that left because they depend on newer ones (see GrowingQr::drop).
  std::vector<int> drop(double limit);
  const GrowingQr& qr() const { return qr_; }
  /// to += W c.
  void add(const Eigen::VectorXd& c, Iterate& to) const;
  void save(io::CheckpointWriter& file, const std::string& name, const IterateOrder& order) const;
  void load(io::CheckpointReader& file, const std::string& name, const IterateOrder& order);

 private:
  GrowingQr qr_;
  std::deque<Iterate> images_;
};

/// What both quasi-Newton methods do alike: differences between one pass and the next, the first update of a
/// run, and the guard against a bad update.
///
/// The guard: an update that used earlier steps' pairs and made the residual ten times larger than at the
/// pass before shows that these pairs describe another map; all of them are given up, those of this step
/// stay. An update that is not finite is replaced by a relaxation and all pairs are given up.
class Secants {
 public:
  explicit Secants(MPI_Comm comm) : comm_(comm) {}
  struct Pair {
    std::vector<double> residual;
    Iterate image;
  };
  void forget_pass() { last_.reset(); }
  /// The difference to the pass before, if there was one in this step and the two differ; remembers this
  /// pass.
  std::optional<Pair> pair(const Iterate& x, const Iterate& image);
  const std::vector<double>& residual() const { return last_->residual; }
  /// Of this pass' residual to that of the pass before; 0 for a first pass.
  double growth() const { return growth_; }
  bool finite(const Iterate& x) const;
  /// Share of the residual in the update from x: (next - x) . r / r . r.
  double share(const Iterate& x, const Iterate& next) const;
  static constexpr double bad_growth = 10;

 private:
  MPI_Comm comm_;
  std::optional<Pair> last_;
  double growth_ = 0;
};

/// Quasi-Newton with the inverse Jacobian from a least-squares problem over this and earlier steps (IQN-ILS)
/// [Degroote, Bathe, Vierendeels 2009; filter: Haelterman et al. 2016]:
///   x^{k+1} = H(x^k) + W c,  c = argmin |r^k + V c|,
/// the columns of V, W being the differences of r and of H(x) between two passes of one step. In the
/// direction of r that no column spans it is the plain iteration. Without any column: x += omega r.
class LeastSquaresNewton final : public Accelerator {
 public:
  LeastSquaresNewton(const AccelerationParameters& parameters, MPI_Comm comm);
  void start_step() override;
  Iterate next(Iterate x, const Iterate& image) override;
  void accept(const Iterate& x, const Iterate& image) override;
  void map_changed() override { secants_.forget_pass(); }
  double relaxation() const override { return share_; }
  int columns() const override { return pairs_.columns(); }
  long resets() const override { return resets_; }
  void save(io::CheckpointWriter& file, const IterateOrder& order) const override;
  void load(io::CheckpointReader& file, const IterateOrder& order) override;

 private:
  void learn(const Iterate& x, const Iterate& image);
  void give_up_earlier_steps();
  void clear();

  AccelerationParameters parameters_;
  Secants secants_;
  SecantPairs pairs_;
  std::deque<double> step_of_;  // of each column: number of its step
  double step_ = 0, share_;
  bool open_ = false, used_earlier_ = false;
  long resets_ = 0;
};

/// Multi-vector quasi-Newton (IQN-MVJ) [Bogaers et al. 2014], matrix-free: the inverse Jacobian of the last
/// steps is corrected by this step's differences, which it has to meet,
///   J = W V^+ + J_old (I - V V^+),  x^{k+1} = H(x^k) - J r^k,
/// applied as a product over the kept steps, newest first. Each step's QR stays as it was made: an update
/// costs 4 m flops a row for m columns where the least-squares method needs 14 m.
class MultiVectorNewton final : public Accelerator {
 public:
  MultiVectorNewton(const AccelerationParameters& parameters, MPI_Comm comm);
  void start_step() override;
  Iterate next(Iterate x, const Iterate& image) override;
  void accept(const Iterate& x, const Iterate& image) override;
  void map_changed() override { secants_.forget_pass(); }
  double relaxation() const override { return share_; }
  int columns() const override;
  long resets() const override { return resets_; }
  void save(io::CheckpointWriter& file, const IterateOrder& order) const override;
  void load(io::CheckpointReader& file, const IterateOrder& order) override;

 private:
  void learn(const Iterate& x, const Iterate& image);

  AccelerationParameters parameters_;
  MPI_Comm comm_;
  Secants secants_;
  std::deque<SecantPairs> steps_;  // newest first; the step under way is the first while open_
  double share_;
  bool open_ = false;
  long resets_ = 0;
};

}  // namespace couplet::coupler
