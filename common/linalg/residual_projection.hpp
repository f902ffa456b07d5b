// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <mpi.h>

#include <Eigen/Dense>
#include <span>
#include <vector>

#include "common/linalg/matrix.hpp"

namespace couplet::linalg {

/// Initial guess for a sequence of right-hand sides with one matrix: the combination of earlier corrections
/// with the smallest residual [fischer1998]. Only corrections of accepted solves are kept, so a repeated
/// solve starts from the same guess.
class ResidualProjection {
 public:
  static constexpr int most = 16;

  /// `depth` is the number of corrections to keep, 1 to `most`.
  ResidualProjection(MPI_Comm comm, int depth) : comm_(comm), depth_(depth) {}

  /// Improves the guess `x` and its residual `r` on the rows of this rank. Returns false if nothing was
  /// changed. Collective.
  bool project(std::span<double> r, std::span<double> x);
  /// Records that the solve ended at `x` with the residual `r`.
  void finish(std::span<const double> r, std::span<const double> x);
  /// Replaces the oldest correction by that of the last solve. Collective.
  void accept();

  /// Returns true if there are no corrections, consistently on all ranks.
  bool is_empty() const { return kept_.empty(); }
  /// State for checkpoints. products() holds number and products, the same on all ranks. vectors() holds
  /// corrections and images in turn, on the rows of this rank.
  std::vector<double> products() const;
  std::vector<std::span<const double>> vectors() const;
  /// Number of vectors that belong to such products.
  static std::size_t vectors_of(std::span<const double> products);
  /// Restores the state. `apply` is A. Discards everything if another operator made it or there are too many.
  /// Collective.
  void set_values(std::span<const double> products, std::vector<std::vector<double>> vectors,
                  const LinearMap& apply);

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
