// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "common/linalg/lanes/slices.hpp"
#include "common/parallel/index_map.hpp"

namespace couplet::linalg {

/// Which cells are neighbours: two local cells a face, at least one of them owned. By reference.
struct CellGraph {
  const parallel::IndexMap& cells;
  MPI_Comm comm;  ///< of `cells`
  std::span<const Index> owner, neighbour;
};

/// A symmetric matrix with a row for each cell and an entry for each two neighbours. Faces between a cell and itself do not count.
class CellMatrix {
 public:
  explicit CellMatrix(const CellGraph& graph);
  /// `diagonal` per owned cell, `faces` the entry of each.
  void fill(std::span<const double> diagonal, std::span<const double> faces);
  /// y = A x, sum of x y over this rank's rows. Both with_room(n_local); ghosts of x are current.
  double multiply(const double* x, double* y) const;
  const std::vector<double>& diagonal() const { return diagonal_; }

  /// Compressed rows with both triangles but without the diagonal, of these entries of the faces. `zeros`: with those that are 0, so that the places are the
  /// same for all values.
  struct Rows {
    std::vector<Index> offset{0}, index;
    std::vector<double> value;
  };
  Rows rows(std::span<const double> faces, bool zeros) const;
  const CellGraph& graph() const { return graph_; }

 private:
  friend double multiply_pass(const CellMatrix& a, const double* x, double* y);
  double multiply_loop(const double* x, double* y) const;
  CellGraph graph_;
  Slices<double> slices_;
  std::vector<Index>
      slot_;  // of each face: its entry in the owner's row and in the neighbour's; below 0: none
  std::vector<double> diagonal_;
};

}  // namespace couplet::linalg
