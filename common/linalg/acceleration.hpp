// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <mpi.h>

#include <span>
#include <vector>

namespace couplet::linalg {

/// Acceleration of a fixed-point iteration u <- u + f(u).
struct Acceleration {
  enum class Type {
    none,
    aitken,    ///< thesis (2.70)-(2.72) with erratum: after every n-th step
    anderson,  ///< [walker2011]: the combination of the last m steps with the smallest residual
  };
  Type type = Type::none;
  int every = 5;    ///< n of Aitken
  int history = 5;  ///< m of Anderson
};

/// Accelerates the unknowns of an iteration. Collective.
class VectorAccelerator {
 public:
  VectorAccelerator(MPI_Comm comm, std::size_t n, const Acceleration& options);

  void restart();
  /// Computes the next iterate from `u` and `step` = f(u).
  void advance(std::span<double> u, std::span<const double> step);

 private:
  void aitken(std::span<double> u, std::span<const double> step);
  void anderson(std::span<double> u, std::span<const double> step);

  MPI_Comm comm_;
  Acceleration options_;
  int steps_ = 0;
  std::vector<double> last_u_, last_step_;
  std::vector<std::vector<double>> du_, df_;  // differences of the last iterates and steps, newest last
  std::vector<double> products_;              // of df_ with each other, a matrix of `history` columns
};

}  // namespace couplet::linalg
