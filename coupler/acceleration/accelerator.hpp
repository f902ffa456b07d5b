// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <mpi.h>

#include <algorithm>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "common/io/checkpoint.hpp"
#include "common/parallel/index_map.hpp"
#include "coupler/parameters/parameters.hpp"

namespace couplet::coupler {

/// One vector of the fixed-point problem x = H(x): this rank's part of the unknown, and dependent data that
/// undergo the same linear combinations, such as the velocity of a displacement.
struct Iterate {
  std::vector<double> unknown;    ///< any unit
  std::vector<double> dependent;  ///< any unit, any length; may be empty
};

/// Residual of one datum. Those of several data have units of their own: only `relative` ones compare.
struct Residual {
  double relative = 0;  ///< |r|_2 over the change in the step, see Unknown::measure(); 0 if nothing moves
  double absolute = 0;  ///< root mean square of the vectors r over the places [unit of the datum]
  double size = 0;      ///< the same of H(x)
  /// Scale of the datum, for later residuals: its size, or, while it has none, its first residual.
  double scale() const { return size > 0 ? size : absolute; }
};

/// Order of its values in a file, independent of the number of ranks.
struct IterateOrder {
  parallel::GlobalOrder unknown, dependent;
  /// Order by rank. Collective.
  static IterateOrder as_they_are(MPI_Comm comm, const Iterate& x) {
    return {parallel::GlobalOrder::as_they_are(comm, x.unknown.size()),
            parallel::GlobalOrder::as_they_are(comm, x.dependent.size())};
  }
};
/// Archives `n` vectors in such an order, each a column of one field. Collective.
void visit_columns(io::Archive& archive, const parallel::GlobalOrder& order, const std::string& name,
                   std::vector<std::vector<double>>& columns, std::size_t n);

/// Computes the next guess of x = H(x) from previous passes, such that r = H(x) - x vanishes. Vectors are
/// flat and distributed. Scalar products are over the communicator of make_accelerator(); all calls are
/// collective over it.
///
///   start_step()  next()  next() ... accept()      a step with any number of passes
///   start_step()  next()  start_step()  ...        a step that is abandoned and repeated
class Accelerator {
 public:
  virtual ~Accelerator() = default;
  /// Begins a step and forgets one that was not accepted.
  virtual void start_step() = 0;
  /// Returns the next x after a pass from x to image = H(x). Move x in if it is no longer needed: a
  /// relaxation works in place.
  virtual Iterate next(Iterate x, const Iterate& image) = 0;
  /// Ends a converged step with its last pass, for which `next` was not called.
  virtual void accept(const Iterate& x, const Iterate& image) = 0;
  /// Declares that H changes within the step. No difference is taken across this call.
  virtual void map_changed() = 0;
  /// Share of r that led to the current x: the factor of a relaxation, otherwise (dx . r)/(r . r). In the
  /// first pass of a step, whose x is the guess, it is the factor of the first update.
  virtual double relaxation() const = 0;
  /// Pairs of differences in use (0 for relaxations), and the number of times old ones were discarded.
  virtual int columns() const { return 0; }
  virtual long resets() const { return 0; }
  /// Call only between steps. A restart is bitwise identical for the same number of ranks. Collective.
  virtual void visit(io::Archive& archive, const IterateOrder& order) = 0;
};

std::unique_ptr<Accelerator> make_accelerator(const AccelerationParameters& parameters, MPI_Comm comm);

/// x += omega (image - x), for unknown and dependent.
void relax(Iterate& x, double omega, const Iterate& image);
/// Sums over all ranks of a few values at once, in place.
void sum_over(MPI_Comm comm, std::span<double> values);
double dot(std::span<const double> a, std::span<const double> b);  // of this rank
/// Sums over this rank, computed in one sweep.
struct ChangeSquares {
  double change = 0, size = 0;  ///< |a - b|^2, |a|^2
};
ChangeSquares squares_of_change(std::span<const double> a, std::span<const double> b);
/// Calls work(first, count) for blocks of `rows` entries that fit in the cache, so that operations on the
/// same arrays read memory once.
template <class Work>
void for_blocks(std::size_t rows, Work work) {
  constexpr std::size_t block = 1024;
  for (std::size_t first = 0; first < rows; first += block) work(first, std::min(block, rows - first));
}

/// x += omega r with a constant omega.
class ConstantRelaxation final : public Accelerator {
 public:
  explicit ConstantRelaxation(double omega) : omega_(omega) {}
  void start_step() override {}
  Iterate next(Iterate x, const Iterate& image) override;
  void accept(const Iterate&, const Iterate&) override {}
  void map_changed() override {}
  double relaxation() const override { return omega_; }
  void visit(io::Archive&, const IterateOrder&) override {}

 private:
  double omega_;
};

/// x += omega r with Aitken's factor, thesis (4.23) with its erratum [Kuettler, Wall 2008]:
///   omega^{k+1} = -omega^k r^k . (r^{k+1} - r^k) / |r^{k+1} - r^k|^2
/// It is kept if the residual did not change, and bounded by 10. Its sign is
/// free: a map with slope above 1 needs a negative one. The first factor of a step is that found by the
/// second pass of the last step, the best one for a first residual, between 0.001 and 1.
/// Later factors belong to the remaining modes and would be too small or too large. r includes the dependent
/// velocities, scaled to the unknown by the first residual of the step. Otherwise a structure whose velocity
/// is another function of its displacement than the guess's (one with sub-steps) has errors invisible in the
/// displacement, which a factor from it alone would amplify.
class AitkenRelaxation final : public Accelerator {
 public:
  AitkenRelaxation(const AccelerationParameters& parameters, MPI_Comm comm);
  void start_step() override;
  Iterate next(Iterate x, const Iterate& image) override;
  void accept(const Iterate& x, const Iterate& image) override;
  void map_changed() override { forget_pass(); }
  double relaxation() const override { return omega_; }
  void visit(io::Archive& archive, const IterateOrder&) override { archive.common("omega", first_); }

 private:
  void take_residual(const Iterate& x, const Iterate& image);
  void learn();
  void forget_pass() { knows_pass_ = false; }

  AccelerationParameters parameters_;
  MPI_Comm comm_;
  double omega_, first_;                          // current factor; for the first update of the next step
  double dependent_weight_ = 0;                   // for this step, from its first residual
  bool second_pass_ = false;                      // the next pass is the second of this step
  bool knows_pass_ = false;                       // last_residual_ is from this step
  std::vector<double> residual_, last_residual_;  // buffers kept between passes
};

/// Aitken's factor from the values of this rank.
double aitken_factor(double omega, std::span<const double> residual, std::span<const double> next_residual,
                     MPI_Comm comm = MPI_COMM_SELF);

/// True if the residual of every datum is below its bound.
bool has_converged(const std::vector<Residual>& residuals, const ConvergenceParameters& parameters);
/// Returns the residual of the datum with the largest relative one.
Residual worst(const std::vector<Residual>& residuals);
/// Returns the largest absolute residual over the `scale` of its datum. Data without a scale yet (0) are
/// omitted.
double largest(const std::vector<Residual>& residuals, const std::vector<double>& scales);

/// Solution of a step.
struct FixedPointResult {
  Iterate x, image;  ///< x and H(x) of the last pass
  Residual residual;
  int iterations = 0;
  bool converged = true;  ///< false: accepted without convergence
};

}  // namespace couplet::coupler
