// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "common/linalg/poisson/cell_matrix.hpp"
#include "common/linalg/poisson/cell_solver.hpp"

namespace couplet::linalg {

/// Entries that a matrix has beside those of the mesh: in the row of an owned cell. Symmetric as a whole.
struct Beside {
  std::span<const Index> row;
  std::span<const GlobalIndex> column;
};

/// By PETSc: where cells are coupled that are no neighbours, and by direct methods on several ranks.
class PetscCellSolver final : public CellSolver {
 public:
  PetscCellSolver(std::string what, const CellGraph& graph, const Beside& beside, LinearMethod method);
  void fill(std::span<const double> diagonal, std::span<const double> faces,
            std::span<const double> beside) override;
  SolveStatistics solve(std::span<const double> b, std::span<double> x, double relative,
                        double absolute) override {
    return solver_.solve(b, x, relative, absolute);
  }
  void refresh() override { solver_.refresh(); }
  PreconditionerMemory memory() const override { return solver_.memory(); }
  void restore(const PreconditionerMemory& memory) override { solver_.restore(memory); }
  int preconditioners_built() const override { return solver_.preconditioners_built(); }
  double norm(std::span<const double> values) const override { return solver_.norm(values); }
  double true_residual(std::span<const double> b, std::span<const double> x) override {
    return solver_.true_residual(b, x);
  }

 private:
  SparseMatrix make_matrix(const Beside& beside);
  CellGraph graph_;
  std::vector<double> values_;  // the matrix's triplets
  SparseMatrix matrix_;
  LinearSolver solver_;
};

}  // namespace couplet::linalg
