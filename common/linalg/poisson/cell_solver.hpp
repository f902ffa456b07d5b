// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "common/linalg/linear_solver.hpp"

namespace couplet::linalg {

/// Solves a symmetric positive definite system of one unknown a cell, whose preconditioner is kept while it is effective and can be made
/// again from its matrix. All collective.
class CellSolver {
 public:
  virtual ~CellSolver() = default;
  /// The matrix: `diagonal` per owned cell, `faces` the entry of each two neighbours, `beside` what is coupled beyond that.
  virtual void fill(std::span<const double> diagonal, std::span<const double> faces,
                    std::span<const double> beside) = 0;
  /// `x` holds the guess on entry. Stops at max(relative |b|, absolute). Throws SolveFailure.
  virtual SolveStatistics solve(std::span<const double> b, std::span<double> x, double relative,
                                double absolute) = 0;
  /// A new preconditioner at the next solve.
  virtual void refresh() = 0;
  virtual PreconditionerMemory memory() const = 0;
  /// Makes the preconditioner now, of the matrix as it stands: the one that `memory` goes with.
  virtual void restore(const PreconditionerMemory& memory) = 0;
  virtual int preconditioners_built() const = 0;
  virtual double norm(std::span<const double> values) const = 0;
  /// |b - A x|.
  virtual double true_residual(std::span<const double> b, std::span<const double> x) = 0;
};

}  // namespace couplet::linalg
