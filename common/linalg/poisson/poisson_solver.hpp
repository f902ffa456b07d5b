// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "common/linalg/poisson/cell_matrix.hpp"
#include "common/linalg/poisson/cell_solver.hpp"

namespace couplet::linalg {

class ColouredMultigrid;
class SingleFactors;

/// Conjugate gradients for one unknown a cell, without PETSc, which a small job would load for nothing. The preconditioner is kept
/// while it is effective and can be made again from its matrix, as LinearSolver's; it is in single precision: Cholesky factors (one
/// rank; in double precision where cells are too thin) or a multigrid cycle.
class PoissonSolver final : public CellSolver {
 public:
  enum class Preconditioner { factors, multigrid };
  /// `what` names the unknown in messages.
  PoissonSolver(std::string what, const CellGraph& graph, Preconditioner kind);
  ~PoissonSolver() override;

  /// Nothing `beside`.
  void fill(std::span<const double> diagonal, std::span<const double> faces,
            std::span<const double> beside) override;
  SolveStatistics solve(std::span<const double> b, std::span<double> x, double relative,
                        double absolute) override;
  void refresh() override { memory_.is_due = true; }
  PreconditionerMemory memory() const override { return memory_; }
  void restore(const PreconditionerMemory& memory) override;
  int preconditioners_built() const override { return built_; }
  double norm(std::span<const double> values) const override;
  double true_residual(std::span<const double> b, std::span<const double> x) override;

 private:
  struct Goal {
    double residual;
    int most;
  };
  void make_preconditioner();
  void precondition(double size);
  void start(std::span<const double> b, std::span<const double> x);
  bool iterate(std::span<double> x, const Goal& goal, SolveStatistics& statistics);
  bool attempt(std::span<const double> b, std::span<double> x, const Goal& goal, SolveStatistics& statistics);

  std::string what_;
  Preconditioner kind_;
  CellMatrix matrix_;
  std::vector<double> faces_;
  std::unique_ptr<SingleFactors> factors_;        // null: none yet
  std::unique_ptr<ColouredMultigrid> multigrid_;  // the same
  double constant_ = 0;  // 1/(1.A 1), by which constants are answered beside multigrid; 0: they are not
  PreconditionerMemory memory_;
  int built_ = 0;
  double rz_step_ = 0;  // of the last iteration: along p
  std::vector<double> r_, p_, q_, z_;
};

}  // namespace couplet::linalg
