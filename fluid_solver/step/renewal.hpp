// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <mpi.h>

#include "fluid_solver/state/state.hpp"

namespace couplet::fluid {

/// Decides when a semi-implicit step repeats its prediction, and with which wall velocity. Friction uses the
/// guessed wall velocity w*, which acts like an unseen mass E beside the mass M of the loop. Repeated
/// predictions are a fixed-point iteration g -> w(g) with contraction E/M, relaxed by Aitken's factor from
/// the second one on. Cases whose passes never converged slowly have heavy structures and need no repetition.
template <int D>
class Renewal {
 public:
  /// Starts the first pass of a step, whose prediction uses w.
  void start(const Vectors<D>& w);
  /// Takes a further pass with w. `unseen`: friction force due to w - guess(), relative to the load. Returns
  /// true if the prediction must be repeated with guess(). Collective.
  bool wanted(MPI_Comm comm, const Vectors<D>& w, double unseen);
  const Vectors<D>& guess() const { return guess_; }
  int count() const { return count_; }
  /// Largest contraction from a second to a third pass over the run, for checkpoints.
  double& slowest() { return slowest_; }

 private:
  double contraction(MPI_Comm comm, const Vectors<D>& w);
  bool is_good(MPI_Comm comm, const Vectors<D>& w) const;
  void move_guess(MPI_Comm comm, const Vectors<D>& w);

  Vectors<D> guess_, gap_;  // gap_: w - guess at the last renewal
  Vectors<D> last_;         // w of the previous pass
  double factor_ = 1, slowest_ = 0, last_change_ = 0;
  int passes_ = 0;  // with the current prediction
  int count_ = 0;   // renewals in the step
};

}  // namespace couplet::fluid
