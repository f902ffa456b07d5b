// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <mpi.h>

#include <algorithm>
#include <memory>
#include <span>
#include <vector>

#include "common/parallel/index_map.hpp"
#include "coupler/parameters/parameters.hpp"

namespace couplet::io {
class CheckpointReader;
class CheckpointWriter;
}  // namespace couplet::io

namespace couplet::coupler {

/// One vector of the fixed point x = H(x): this rank's part of the unknown, and what is no unknown of its own
/// but undergoes the same linear combinations (the velocity that goes with a displacement).
struct Iterate {
  std::vector<double> unknown;  ///< any unit
  std::vector<double> rider;    ///< any unit, any length; may be empty
};

/// The order of its values on file, the same on any ranks.
struct IterateOrder {
  parallel::GlobalOrder unknown, rider;
  /// Rank by rank as they are. Collective.
  static IterateOrder as_they_are(MPI_Comm comm, const Iterate& x) {
    return {parallel::GlobalOrder::as_they_are(comm, x.unknown.size()),
            parallel::GlobalOrder::as_they_are(comm, x.rider.size())};
  }
};
/// Vectors in such an order, each a column of one field. Collective.
using Columns = std::vector<std::span<const double>>;
void write_columns(io::CheckpointWriter& file, const parallel::GlobalOrder& order, const std::string& name,
                   const Columns& columns);
std::vector<std::vector<double>> read_columns(io::CheckpointReader& file, const parallel::GlobalOrder& order,
                                              const std::string& name, std::size_t n);

/// How the next guess of x = H(x) follows from the passes made so far: r = H(x) - x is to vanish. Vectors are
/// flat and distributed, scalar products are taken over `comm` of the maker; all calls are collective over
/// it.
///
///   start_step()  next()  next() ... accept()      a step, however many passes it needs
///   start_step()  next()  start_step()  ...        a step that was given up and is tried again
class Accelerator {
 public:
  virtual ~Accelerator() = default;
  /// A step begins; one that was not accepted is forgotten.
  virtual void start_step() = 0;
  /// The next x after a pass from x to image = H(x). Give x away where it is not needed any more: a relaxation
  /// works in its place.
  virtual Iterate next(Iterate x, const Iterate& image) = 0;
  /// The step has converged with this last pass, which `next` was not called for.
  virtual void accept(const Iterate& x, const Iterate& image) = 0;
  /// H is another map from now on, though the step goes on: no difference is taken across this.
  virtual void map_changed() = 0;
  /// Share of r that led to the x of the pass under way: the factor of a relaxation, (dx . r) / (r . r) else.
  /// In the first pass of a step, whose x is the guess, the factor that the first update would take.
  virtual double relaxation() const = 0;
  /// Pairs of differences in use (0 for relaxations), and how often old ones were given up as misleading.
  virtual int columns() const { return 0; }
  virtual long resets() const { return 0; }
  /// Between steps only. After load the run continues bit for bit on equal ranks. Collective.
  virtual void save(io::CheckpointWriter& file, const IterateOrder& order) const = 0;
  virtual void load(io::CheckpointReader& file, const IterateOrder& order) = 0;
};

std::unique_ptr<Accelerator> make_accelerator(const AccelerationParameters& parameters, MPI_Comm comm);

/// x += omega (image - x), of unknown and rider.
void relax(Iterate& x, double omega, const Iterate& image);
/// Sums over all ranks of a few values at once, in place.
void sum_over(MPI_Comm comm, std::span<double> values);
double dot(std::span<const double> a, std::span<const double> b);  // of this rank
/// Of this rank, in one sweep.
struct ChangeSquares {
  double change = 0, size = 0;  ///< |a - b|^2, |a|^2
};
ChangeSquares squares_of_change(std::span<const double> a, std::span<const double> b);
/// Calls work(first, count) for stretches of `rows` entries that stay in the cache: operations on the same arrays read
/// them from memory once.
template <class Work>
void for_blocks(std::size_t rows, Work work) {
  constexpr std::size_t block = 1024;
  for (std::size_t first = 0; first < rows; first += block) work(first, std::min(block, rows - first));
}

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
