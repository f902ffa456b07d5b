// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "coupler/acceleration/accelerator.hpp"

namespace couplet::coupler {

/// x += omega r with the same omega always.
class ConstantRelaxation final : public Accelerator {
 public:
  explicit ConstantRelaxation(double omega) : omega_(omega) {}
  void start_step() override {}
  Iterate next(Iterate x, const Iterate& image) override;
  void accept(const Iterate&, const Iterate&) override {}
  void map_changed() override {}
  double relaxation() const override { return omega_; }
  void save(io::CheckpointWriter&, const IterateOrder&) const override {}
  void load(io::CheckpointReader&, const IterateOrder&) override {}

 private:
  double omega_;
};

/// x += omega r with Aitken's factor, thesis (4.23) with its erratum [Kuettler, Wall 2008]:
///   omega^{k+1} = -omega^k r^k . (r^{k+1} - r^k) / |r^{k+1} - r^k|^2
/// kept if the residual did not change at all, and in size never above ten times `maximum-relaxation` (its
/// sign is free: a map of slope above 1 needs a negative one). The first factor of a step is what the second
/// pass of the last step found out, i.e. the best factor for a first residual, between a thousandth and
/// `maximum-relaxation`; the later ones belong to the modes that were left over and would start a step too
/// small or too large. r holds the velocities that ride along, scaled to the size of the unknown by the first
/// residual of the step: a structure whose velocity is not the same function of its displacement as the guess's
/// (one that takes sub-steps) has errors that the displacement alone does not show, and a factor from these would
/// feed them.
class AitkenRelaxation final : public Accelerator {
 public:
  AitkenRelaxation(const AccelerationParameters& parameters, MPI_Comm comm);
  void start_step() override;
  Iterate next(Iterate x, const Iterate& image) override;
  void accept(const Iterate& x, const Iterate& image) override;
  void map_changed() override { forget_pass(); }
  double relaxation() const override { return omega_; }
  void save(io::CheckpointWriter& file, const IterateOrder& order) const override;
  void load(io::CheckpointReader& file, const IterateOrder& order) override;

 private:
  void take_residual(const Iterate& x, const Iterate& image);
  void learn();
  void forget_pass() { knows_pass_ = false; }

  AccelerationParameters parameters_;
  MPI_Comm comm_;
  double omega_, first_;                          // in use; for the first update of the next step
  double rider_weight_ = 0;                       // of this step, from its first residual
  bool second_pass_ = false;                      // of this step comes next
  bool knows_pass_ = false;                       // of this step: last_residual_ is its residual
  std::vector<double> residual_, last_residual_;  // buffers that stay from pass to pass
};

/// The factor itself, over the values of this rank.
double aitken_factor(double omega, std::span<const double> residual, std::span<const double> next_residual,
                     MPI_Comm comm = MPI_COMM_SELF);

}  // namespace couplet::coupler
