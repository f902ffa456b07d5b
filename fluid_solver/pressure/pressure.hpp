// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "common/io/checkpoint.hpp"
#include "common/linalg/cell_solver.hpp"
#include "fluid_solver/boundary/boundary.hpp"
#include "fluid_solver/state/placement.hpp"

namespace couplet::fluid {

/// Additions to the diagonal; an empty vector adds nothing.
struct Diagonal {
  std::vector<double> faces;  ///< per boundary face [m]
  std::vector<double> cells;  ///< per owned cell [m]
};

/// A = -sum_f g (p_N - p_P), plus g p_P at faces of given pressure: symmetric, positive (semi-)definite.
/// Faces of given flux have no entry. The sparsity is fixed; a moved mesh only changes the values.
template <int D>
class PressureEquation {
 public:
  /// `fixed`: the mesh is at rest, so nothing is kept for a second set().
  PressureEquation(const mesh::Mesh& mesh, const Boundary<D>& boundary, bool fixed);
  /// `regular`: the additions determine the level in a closed domain. Collective.
  void set(const Placement<D>& at, bool regular = false, const Diagonal& added = {});
  /// True if the pressure is determined only up to a constant.
  bool singular() const { return boundary_.closed() && !regular_; }
  /// Saves the matrix from which the preconditioner was made, so that it can be rebuilt. A fixed matrix needs
  /// no saving.
  void save(io::CheckpointWriter& file) const;
  /// Makes the present state the one that save() saves.
  void accept() { accepted_ = now_; }
  /// Restores the matrix of the preconditioner: call set() before the next solve. Collective.
  void load(io::CheckpointReader& file);
  /// Rebuilds the preconditioner at the next solve.
  void refresh() {
    if (solver_) solver_->solver().refresh();
  }
  /// `b`: per owned cell, made compatible here in a closed domain. `p`: per local cell, guess on entry; on
  /// exit with current ghosts, and zero mean in a closed domain (at its convective outlets, if any). Stops at
  /// max(relative |b|, absolute). `answer` also reduces the residual of the guess to this share, down to
  /// least_answer relative |b|, so that a partner that changes b sees the response of p. `size`: replaces |b|
  /// unless negative. Collective.
  linalg::SolveStatistics solve(const Placement<D>& at, std::vector<double>& b, std::vector<double>& p,
                                double relative, double absolute, double answer = 0, double size = -1);
  static constexpr double least_answer = 1e-4;

 private:
  void make_solver();
  std::vector<double> diagonal(const Placement<D>& at, const Diagonal& added) const;
  void remove_mean(std::vector<double>& b) const;
  linalg::SolveStatistics solve_or_tell(const Placement<D>& at, std::span<const double> b,
                                        std::span<double> p, double relative, double absolute);
  const mesh::Mesh& mesh_;
  const Boundary<D>& boundary_;
  bool fixed_, regular_ = false;
  bool pinned_ = true;  // one cell's pressure is zero if it is determined up to a constant
  bool direct_;         // small 2-D meshes: Cholesky factors are kept
  std::unique_ptr<linalg::CellSolver> solver_;
  void fill(std::span<const double> coefficients);
  // Moving mesh only. Matrix entries: diagonal per owned cell, then one entry per face. The
  // preconditioner is stored with the entries it was made from, now and at the accepted level.
  std::vector<double> values_;
  struct Lagging {
    linalg::PreconditionerMemory memory;
    std::shared_ptr<const std::vector<double>> made_from;
  };
  Lagging now_, accepted_;
};

}  // namespace couplet::fluid
