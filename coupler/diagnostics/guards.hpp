// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <mpi.h>

#include <deque>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "common/coupling/participant.hpp"
#include "common/parallel/index_map.hpp"

namespace couplet::io {
class Archive;
}

namespace couplet::coupler {

/// Watches the residuals of one step: a coupling that runs away is named within a few passes instead of when
/// the allowed passes are used up.
class IterationGuard {
 public:
  void start_step() { *this = {}; }
  /// After each pass: |r| (any norm, the same in all passes) and the factor that led to its x. Throws
  /// SchemeFailure where constant relaxation meets too much added mass (each mode's error has the factor
  /// 1 - omega (1 + r), Causin, Gerbeau and Nobile 2005: no smaller step helps), SolveFailure where an
  /// accelerated residual has grown over `patience` passes or by `too_far` in all.
  void pass(double residual, double omega, bool constant);

  /// After a pass that a participant could not answer: a reason if the residual was growing before, else nothing. A motion
  /// that runs away folds a mesh long before `patience` passes are over. `relaxation`: the constant one; 0: adapted.
  std::optional<std::string> suspects(double relaxation) const;

  static constexpr int patience = 5;
  static constexpr double too_far = 1e6;

 private:
  bool grows() const;
  double factor() const;  // a pass

  double first_ = 0, last_ = 0;
  int passes_ = 0, growing_ = 0;
  double at_turn_ = 0;  // residual at which the growth began
};

/// Watches the accepted motion for the two-step oscillation of loosely coupled schemes: jumps of the
/// velocity, d_n = (x^{n+1} - x^n) / dt_n - (x^n - x^{n-1}) / dt_{n-1}, that turn round in every step, are as
/// large as the velocity itself and grow; steps of other lengths do not hide it. The added mass taken
/// explicitly has the factor -r a step (r: added mass over the structure's), whatever the step; the
/// semi-implicit scheme does the same with what viscosity adds (it takes the wall shear at the guessed
/// velocity).
class OscillationGuard {
 public:
  /// `comm`: over whose ranks the motion is cut. `tolerance`: of the coupling, over the largest motion of the run; swings below
  /// it are its noise.
  explicit OscillationGuard(MPI_Comm comm = MPI_COMM_SELF, double tolerance = 0)
      : comm_(comm), tolerance_(tolerance) {}
  /// The motion x of an accepted step of length dt, this rank's part. A reason if it oscillates, else
  /// nothing.
  std::optional<std::string> accepted(const std::vector<double>& x, double dt, coupling::Scheme scheme);
  /// After a step that failed: a reason if the accepted steps before it had begun to swing, else nothing.
  std::optional<std::string> suspects(coupling::Scheme scheme) const;
  /// Steps in a row in which it has turned round.
  int turns() const { return turns_; }

  /// For checkpoints: what is the same on all ranks, and `count` values of the motion from `first` on, in their order.
  void visit_numbers(io::Archive& archive);
  void visit_fields(io::Archive& archive, const parallel::GlobalOrder& order, const std::string& name,
                    std::size_t first, std::size_t count, std::size_t width);

 private:
  MPI_Comm comm_;
  double tolerance_, largest_ = 0;  // largest: norm of x over the run
  std::vector<double> x_, velocity_, jump_;
  int turns_ = 0, levels_ = 0;  // levels: accepted states that are known
  std::vector<double> sizes_;   // of the differences since the turning began
  std::deque<double> speed_;    // of the last steps
};

/// Watches the work on both sides of the interface. What the fluid gives and the structure takes are the same
/// but for the error of the coupling; work that parts more and more is made by the scheme.
class WorkGuard {
 public:
  /// Work of a step on both sides [J]. A reason if the two have parted, else nothing.
  /// When a step cannot be solved: whether the work so far says that the explicit scheme itself made the motion.
  std::optional<std::string> suspects(coupling::Scheme scheme) const;
  std::optional<std::string> accepted(double fluid, double structure, coupling::Scheme scheme);
  /// For the end of the run: a sentence with numbers, and whether the balance is sound.
  struct Verdict {
    bool sound = true;
    std::string text;
    double part = 0;  ///< apart, of the net work or the energy
    bool useless = false;
  };
  /// What is apart is compared with the smaller of the net works, or with the largest energy of the structure where that is
  /// more: work that went there and back again hides nothing. `by_nearest`: motion and load went by the nearest.
  /// `lagging`: one pass per step, where the wall that the fluid sees is extrapolated and its velocity jitters about the
  /// structure's: loads alternate from step to step, and the works part, while the motion may be right to parts in a
  /// thousand. That proves no uselessness (growth is the business of accepted()).
  Verdict verdict(bool by_nearest = false, bool lagging = false) const;
  /// Energy of the structures after a step [J]; NaN: not known. Until one is, the largest net work taken stands for it.
  void energy(double value) { energy_ = value > energy_ ? value : energy_; }

  /// For checkpoints.
  template <class Numbers>
  void visit(Numbers& numbers) {
    numbers(fluid_, structure_, exchanged_, steps_, energy_, stored_, windows_);
  }

  /// Of net work or energy, that apart: sound below the one; of all work exchanged: the answer useless from the other on (of
  /// so many steps at least: the start of a motion parts the work of the first ones).
  static constexpr double sound_part = 0.05, useless_part = 0.5;
  static constexpr long judged_steps = 20;
  static constexpr int window = 12;  ///< steps; it fires after three of them at the earliest

 private:
  double fluid_ = 0, structure_ = 0, exchanged_ = 0;  // sums over the run; exchanged: of the larger |work|
  double energy_ = 0, stored_ = 0;  // the largest: of the structures, net work that they had taken
  long steps_ = 0;
  struct Window {
    double given = 0, taken = 0, size = 0;
    int steps = 0;
    double apart() const;
    template <class Numbers>
    void visit(Numbers& numbers) {
      numbers(given, taken, size, steps);
    }
  };
  std::vector<Window> windows_;  // the last three
};

}  // namespace couplet::coupler
