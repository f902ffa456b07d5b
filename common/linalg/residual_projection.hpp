// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <mpi.h>

#include <Eigen/Dense>
#include <span>
#include <vector>

#include "common/linalg/linear_map.hpp"

namespace couplet::linalg {

/// First guess for one matrix and one right-hand side after another: of the corrections that earlier solves
/// made to their guesses, the combination that leaves the least residual [fischer1998]. The corrections kept
/// are those of accepted solves only, so that a solve that is done again starts from the same place.
class ResidualProjection {
 public:
  static constexpr int most = 8;

  /// `depth`: corrections kept, 1 to `most`.
  ResidualProjection(MPI_Comm comm, int depth) : comm_(comm), depth_(depth) {}

  /// Takes the guess `x` and its residual `r`, rows of this rank, and moves both. Returns whether it did.
  /// Collective.
  bool project(std::span<double> r, std::span<double> x);
  /// The solve ended at `x` with the residual `r`.
  void finish(std::span<const double> r, std::span<const double> x);
  /// Keeps the correction of the last solve in place of the oldest. Collective.
  void accept();

  /// Nothing is kept; the same on all ranks.
  bool is_empty() const { return kept_.empty(); }
  /// All that is kept, rows of this rank: for checkpoints.
  std::vector<double> values() const;
  /// `apply`: A. Forgets all if they were made by another operator or there are more than are kept.
  /// Collective.
  void set_values(std::span<const double> values, const LinearMap& apply);

 private:
  struct Correction {
    std::vector<double> x, image;  // image: A x
  };
  MPI_Comm comm_;
  int depth_;
  bool is_pending_ = false;
  Correction pending_;
  std::vector<Correction> kept_;
  std::size_t oldest_ = 0;
  Eigen::Matrix<double, most, most> gram_ = Eigen::Matrix<double, most, most>::Zero();
};

}  // namespace couplet::linalg
