// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <mpi.h>

#include "fluid_solver/state/placement.hpp"

namespace couplet::fluid {

/// When a step of the semi-implicit scheme repeats its first part, and with which wall velocity. What friction
/// makes of the wall's motion knows the guess w* only: a mass E beside the mass M of the loop. Repetitions are a
/// fixed point of their own, g -> w(g), which contracts by E/M: relaxed by Aitken's factor from the second on.
/// Structures whose passes never converged slowly are heavy beside the fluid and left alone.
template <int D>
class Renewal {
 public:
  /// First pass of a step, whose prediction is made with w.
  void start(const Vectors<D>& w);
  /// A further pass with w. `unseen`: force that friction makes of w - guess(), over the load. True: the
  /// prediction is to be made anew with guess(). Collective.
  bool wanted(MPI_Comm comm, const Vectors<D>& w, double unseen);
  const Vectors<D>& guess() const { return guess_; }
  int count() const { return count_; }
  /// Largest share that a third pass left of the second one's change, over the run: for checkpoints.
  double slowest() const { return slowest_; }
  void restore(double slowest) { slowest_ = slowest; }

 private:
  double contraction(MPI_Comm comm, const Vectors<D>& w);
  bool is_good(MPI_Comm comm, const Vectors<D>& w) const;
  void move_guess(MPI_Comm comm, const Vectors<D>& w);

  Vectors<D> guess_, gap_;  // gap_: w - guess at the last renewal
  Vectors<D> last_;         // w of the pass before
  double factor_ = 1, slowest_ = 0, last_change_ = 0;
  int passes_ = 0;  // of the prediction
  int count_ = 0;   // of renewals in the step
};

}  // namespace couplet::fluid
