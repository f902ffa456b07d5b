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

/// Entries that the matrix has beside those of the mesh: in the row of an owned cell. Symmetric as a whole.
struct Couplings {
  std::vector<Index> row;
  std::vector<GlobalIndex> column;
  std::vector<double> value;  ///< [m]
};

/// Additions to the diagonal; an empty vector adds nothing.
struct Diagonal {
  std::vector<double> faces;  ///< per boundary face [m]
  std::vector<double> cells;  ///< per owned cell [m]
};

/// A = -sum_f g (p_N - p_P), and g p_P at faces of given pressure: symmetric, positive (semi-)definite. Faces
/// of given flux have no entry. The places of the entries are fixed; a moved mesh only refills the values.
template <int D>
class PressureEquation {
 public:
  /// `fixed`: the mesh rests; nothing is kept for a second set(). `couplings`: their places stay, set() takes their
  /// values; nullptr if there are none. They must outlive the equation.
  PressureEquation(const mesh::Mesh& mesh, const Boundary<D>& boundary, bool fixed,
                   const Couplings* couplings = nullptr);
  /// `regular`: what is added gives a closed domain a level. Collective.
  void set(const Placement<D>& at, bool regular = false, const Diagonal& added = {});
  /// The pressure is known up to a constant only.
  bool singular() const { return boundary_.closed() && !regular_; }
  /// The preconditioner lags behind a matrix that moves: what it was made from, to make it again. A fixed matrix needs
  /// none of this.
  void save(io::CheckpointWriter& file) const;
  /// Makes the present state the one that save() saves.
  void accept() { accepted_ = now_; }
  /// The matrix is then that of the preconditioner: set() has to come before the next solve. Collective.
  void load(io::CheckpointReader& file);
  /// A new preconditioner at the next solve.
  void refresh() {
    if (solver_) solver_->solver().refresh();
  }
  /// `b`: per owned cell, made compatible here when the domain is closed; `p`: per local cell, guess on
  /// entry, mean zero in a closed domain (at its convective outlets, if there are any), ghosts current on
  /// exit. Stops at max(relative |b|, absolute). With `answer`, the residual of the guess falls to this share, too, down to
  /// least_answer relative |b|: a partner that changes b sees p change by what it has changed. `size`: in the
  /// place of |b|, below 0: |b| itself. Collective.
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
  const Couplings* couplings_;  // nullptr if there are none
  bool fixed_, regular_ = false;
  bool pinned_ = true;  // where the pressure is known up to a constant, one cell's is zero
  bool direct_;         // small 2-D meshes: kept Cholesky factors
  std::unique_ptr<linalg::CellSolver> solver_;
  void fill(std::span<const double> coefficients);
  // Moving mesh only: the matrix's diagonal per owned cell, one entry a face, then the couplings; and the preconditioner with those
  // that it was made from: now, and as the accepted level had it.
  std::vector<double> values_;
  struct Lagging {
    linalg::PreconditionerMemory memory;
    std::shared_ptr<const std::vector<double>> made_from;
  };
  Lagging now_, accepted_;
};

}  // namespace couplet::fluid
