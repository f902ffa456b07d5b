// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <vector>

#include "common/base/types.hpp"
#include "common/linalg/lanes/slices.hpp"

namespace couplet::linalg {

/// Cholesky factors P A P^T = L L^T of one rank's symmetric positive definite matrix, as a preconditioner.
/// Eigen orders (AMD) and factorises in double precision; L is kept in single precision, by supernodes
/// (columns with nearly the same rows), so that solving reads a third of what a column-by-column factor in
/// double precision has to and runs eight rows at a time.
class SingleFactors {
 public:
  SingleFactors();
  ~SingleFactors();
  SingleFactors(const SingleFactors&) = delete;
  SingleFactors& operator=(const SingleFactors&) = delete;

  /// Compressed rows with both triangles; the pattern is analysed once. Throws SolveFailure if A is not
  /// positive definite.
  void factorise(std::span<const int> offset, std::span<const int> index, std::span<const double> value);
  /// x = A^-1 b but for rounding. Other arrays.
  void apply(std::span<const double> b, std::span<double> x);
  /// The same by the factors in double precision, entry by entry.
  void apply_double(std::span<const double> b, std::span<double> x) const;

 private:
  using Lanes = Eight<float>;
  static constexpr int lanes = slice_width;
  /// Columns [first, first + columns) of L.
  struct Supernode {
    Index first, columns;
    Index groups;          // of `lanes` rows below the columns, the last one filled up with zeros
    std::size_t triangle;  // its entries of triangle_: the inverse of its lower triangle, row by row
    std::size_t rows;      // its entries of row_
    std::size_t
        below;  // its entries of below_: group by group, in each column by column, `lanes` rows together
  };
  struct Analysis;
  void find_supernodes();
  void keep_values();
  void keep(const Supernode& node, const double* block, std::size_t stride);
  void multiply_inverse(const Supernode& node);
  void multiply_transposed(const Supernode& node);
  template <int Columns>
  void spread(const Supernode& node);
  template <int Columns>
  void collect(const Supernode& node);
  template <class Visit>
  static void with_columns(const Supernode& node, const Visit& visit);
  friend void forward_pass(SingleFactors& factors);
  friend void backward_pass(SingleFactors& factors);
  void forward();
  void backward();

  std::unique_ptr<Analysis> analysis_;
  std::vector<Supernode> nodes_;
  std::vector<Index> order_;  // row of A in each row of P A P^T
  std::vector<Index> row_;
  std::vector<float> triangle_;
  std::vector<float> below_, sum_;
  std::vector<float> work_;  // one more than rows: where the filled-up rows go
};

}  // namespace couplet::linalg
