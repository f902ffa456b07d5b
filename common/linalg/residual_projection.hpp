// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <mpi.h>

#include <Eigen/Dense>
#include <span>
#include <vector>

#include "common/linalg/matrix.hpp"

namespace couplet::linalg {

/// First guess for one matrix and one right-hand side after another: of the corrections that earlier solves
/// made to their guesses, the combination that leaves the least residual [fischer1998]. The corrections kept
/// are those of accepted solves only, so that a solve that is done again starts from the same place.
class ResidualProjection {
 public:
  static constexpr int most = 16;

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
  /// For checkpoints: how many there are and their products, the same on all ranks; the vectors themselves, rows of this
  /// rank, correction and image by turns.
  std::vector<double> products() const;
  std::vector<std::span<const double>> vectors() const;
  /// How many vectors belong to such products.
  static std::size_t vectors_of(std::span<const double> products);
  /// `apply`: A. Forgets all if they were made by another operator or there are more than are kept.
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
