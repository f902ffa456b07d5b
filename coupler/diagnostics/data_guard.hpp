// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <mpi.h>

#include <string>
#include <vector>

#include "common/diagnostics/finding.hpp"
#include "coupler/exchange/side.hpp"

namespace couplet::io {
class Archive;
}

namespace couplet::coupler {

/// Watches for two faults of participants that no residual shows by its cause: an answer that does not follow the input (a
/// solver whose first guess meets its own tolerance), and a velocity that is not the rate of the displacement beside it.
class DataGuard {
 public:
  DataGuard(MPI_Comm comm, const std::vector<Side>& sides);

  void start_step();
  /// After each answer of `side` in the passes of a step. Looks from pass `late` on only. Collective.
  void answered(std::size_t side, const coupling::Exchange& taken, const coupling::Exchange& given);
  /// Of a step that was not solved: a sentence on who gave the same answer, to the last bit, in at least half of the late
  /// passes while the input changed; else empty.
  std::string silent() const;

  /// After an accepted step of length dt: once per participant, where the velocity is not the rate of the displacement.
  /// Compared are v^{n+1} and (v^n + v^{n+1})/2 with (x^{n+1} - x^n)/dt, by least squares over the run. Collective.
  std::vector<diagnostics::Finding> accepted(const std::vector<coupling::Exchange>& given, double dt);

  /// For checkpoints.
  void visit(io::Archive& archive, const std::vector<Side>& sides);

  static constexpr int late = 10;                ///< passes
  static constexpr int judged_steps = 10;        ///< before which the velocity is not judged
  static constexpr double doubtful = 0.3;        ///< of the rate, that the velocity may be off
  static constexpr double least_motion = 1e-12;  ///< of the interface's extent, below which nothing moves

 private:
  struct Answers {
    std::string name;
    coupling::Exchange taken, given;
    int passes = 0, looked = 0, same = 0;
  };
  struct Motion {
    std::size_t side;
    std::string name;
    std::vector<double> x, v;                           // of the last accepted step
    double rate_rate = 0, rate_end = 0, rate_mean = 0;  // sums of products over the run
    double extent = 0, largest = 0;                     // [m]
    int steps = 0;
    bool reported = false;
  };
  void add(Motion& one, const std::vector<double>& x, const std::vector<double>& v, double dt) const;

  MPI_Comm comm_;
  std::vector<Answers> answers_;
  std::vector<Motion> motions_;
};

}  // namespace couplet::coupler
