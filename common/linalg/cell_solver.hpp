// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>
#include <vector>

#include "common/linalg/linear_solver.hpp"
#include "common/parallel/index_map.hpp"

namespace couplet::linalg {

/// Neighboring cells: two local cells per face, at least one of them owned. Holds references.
struct CellGraph {
  const parallel::IndexMap& cells;
  MPI_Comm comm;  ///< of `cells`
  std::span<const Index> owner, neighbour;
};

/// Conjugate gradients for a symmetric positive (semi-)definite system with one unknown per cell and a fixed
/// sparsity pattern.
class CellSolver {
 public:
  enum class Preconditioner {
    factors,   ///< Cholesky factors
    multigrid  ///< AggregationMultigrid
  };
  /// `what` names the unknown in messages. Collective.
  CellSolver(std::string what, const CellGraph& graph, Preconditioner kind);
  /// Sets the values: `diagonal` per owned cell, `faces` the entry of each two neighbors. Collective.
  void fill(std::span<const double> diagonal, std::span<const double> faces);
  /// Solver of the system, which refreshes, saves and restores its preconditioner.
  LinearSolver& solver() { return solver_; }

 private:
  SparseMatrix make_matrix();
  LinearMap make_cycle() const;
  CellGraph graph_;
  std::vector<double> diagonal_, faces_, values_;  // values_: the matrix's triplets
  SparseMatrix matrix_;
  LinearSolver solver_;
};

}  // namespace couplet::linalg
