// SPDX-License-Identifier: Apache-2.0
// Lowest modes of operators without entries: shift-invert with the caller's own solver.
#include <slepceps.h>

#include <algorithm>
#include <cmath>
#include <exception>
#include <numeric>

#include "common/base/error.hpp"
#include "common/linalg/petsc_check.hpp"
#include "common/linalg/petsc_shell.hpp"
#include "common/modes/lowest_modes.hpp"

namespace couplet::modes {
namespace {

constexpr double solver_tolerance =
    1e-9;  // of the eigenvalues of the inverse: above what the inner solver leaves
// A mode that the first search hid lies below the last found by more than rounding.
constexpr double hidden_below = 1e-6;

using Apply = ModalOperators::Apply;
using Operator = linalg::ShellOperator;

/// One search; what it needs lives as long as it.
class Search {
 public:
  Search(MPI_Comm comm, std::size_t n_owned, const ModalOperators& of, double shift) : shift_(shift) {
    stiffness_ = {&of.stiffness, &failure_};
    mass_ = {&of.mass, &failure_};
    k_ = linalg::symmetric_shell(comm, n_owned, stiffness_);
    m_ = linalg::symmetric_shell(comm, n_owned, mass_);
    inverse_ = {&of.solve, &failure_};
    linalg::petsc_check(EPSCreate(comm, &eps_));
    linalg::petsc_check(EPSSetOperators(eps_, k_, m_));
    linalg::petsc_check(EPSSetProblemType(eps_, EPS_GHEP));
    linalg::petsc_check(EPSSetType(eps_, EPSKRYLOVSCHUR));
    linalg::petsc_check(EPSSetWhichEigenpairs(eps_, EPS_TARGET_MAGNITUDE));
    linalg::petsc_check(EPSSetTarget(eps_, shift));
    ST st = nullptr;
    KSP ksp = nullptr;
    PC pc = nullptr;
    linalg::petsc_check(EPSGetST(eps_, &st));
    linalg::petsc_check(STSetType(st, STSINVERT));
    linalg::petsc_check(STSetMatMode(st, ST_MATMODE_SHELL));
    linalg::petsc_check(STGetKSP(st, &ksp));
    linalg::petsc_check(KSPSetType(ksp, KSPPREONLY));
    linalg::petsc_check(KSPGetPC(ksp, &pc));
    linalg::petsc_check(PCSetType(pc, PCSHELL));
    linalg::petsc_check(PCShellSetContext(pc, &inverse_));
    linalg::petsc_check(PCShellSetApply(pc, linalg::precondition_shell));
  }
  Search(const Search&) = delete;
  ~Search() {
    if (std::uncaught_exceptions() > 0) return;
    EPSDestroy(&eps_);
    MatDestroy(&k_);
    MatDestroy(&m_);
  }

  /// The lowest n, beside those given. `failure` of the inner solver is thrown on every rank alike: the solver is
  /// collective.
  EigenModes run(int n, std::span<const std::vector<double>> beside) {
    linalg::petsc_check(EPSSetDimensions(eps_, n, PETSC_DEFAULT, PETSC_DEFAULT));
    linalg::petsc_check(EPSSetTolerances(eps_, solver_tolerance, 300));
    std::vector<::Vec> space(beside.size());
    for (std::size_t i = 0; i < beside.size(); ++i) {
      linalg::petsc_check(MatCreateVecs(k_, &space[i], nullptr));
      double* values = nullptr;
      linalg::petsc_check(VecGetArray(space[i], &values));
      std::ranges::copy(beside[i], values);
      linalg::petsc_check(VecRestoreArray(space[i], &values));
    }
    if (!space.empty()) linalg::petsc_check(EPSSetDeflationSpace(eps_, PetscInt(space.size()), space.data()));
    linalg::petsc_check(EPSSolve(eps_));
    for (::Vec& v : space) VecDestroy(&v);
    if (failure_) std::rethrow_exception(failure_);
    return found();
  }

 private:
  EigenModes found() const {
    PetscInt n = 0;
    linalg::petsc_check(EPSGetConverged(eps_, &n));
    EigenModes modes;
    std::vector<double> values;
    std::vector<std::vector<double>> shapes;
    ::Vec x = nullptr, force = nullptr, inertia = nullptr;
    linalg::petsc_check(MatCreateVecs(k_, &x, &force));
    linalg::petsc_check(VecDuplicate(force, &inertia));
    for (PetscInt i = 0; i < n; ++i) {
      double value = 0, residual = 0, size = 0;
      linalg::petsc_check(EPSGetEigenpair(eps_, i, &value, nullptr, x, nullptr));
      linalg::petsc_check(MatMult(k_, x, force));
      linalg::petsc_check(MatMult(m_, x, inertia));
      linalg::petsc_check(VecNorm(inertia, NORM_2, &size));
      linalg::petsc_check(VecAXPY(force, -value, inertia));
      linalg::petsc_check(VecNorm(force, NORM_2, &residual));
      modes.worst_residual = std::max(modes.worst_residual, residual / ((value - shift_) * size));
      const double* entries = nullptr;
      PetscInt rows = 0;
      linalg::petsc_check(VecGetLocalSize(x, &rows));
      linalg::petsc_check(VecGetArrayRead(x, &entries));
      shapes.emplace_back(entries, entries + rows);
      linalg::petsc_check(VecRestoreArrayRead(x, &entries));
      values.push_back(value);
    }
    for (::Vec* v : {&x, &force, &inertia}) linalg::petsc_check(VecDestroy(v));
    std::vector<std::size_t> order(values.size());
    std::iota(order.begin(), order.end(), 0);
    std::ranges::stable_sort(order, {}, [&](std::size_t i) { return values[i]; });
    for (const std::size_t i : order) {
      modes.eigenvalue.push_back(values[i]);
      modes.shape.push_back(std::move(shapes[i]));
    }
    return modes;
  }

  double shift_;
  Operator stiffness_, mass_, inverse_;
  std::exception_ptr failure_;
  EPS eps_ = nullptr;
  Mat k_ = nullptr, m_ = nullptr;
};

void keep(EigenModes& modes, std::size_t n) {
  modes.eigenvalue.resize(n);
  modes.shape.resize(n);
}

}  // namespace

EigenModes lowest_modes(MPI_Comm comm, std::size_t n_owned, const ModalOperators& of, int n, double shift) {
  EigenModes modes = Search(comm, n_owned, of, shift).run(n, {});
  if (static_cast<int>(modes.eigenvalue.size()) < n)
    throw SolveFailure("Only {} of {} modes were found. Request fewer modes or refine the mesh.",
                       modes.eigenvalue.size(), n);
  keep(modes, std::size_t(n));
  // Without factors no pivots can be counted: what is left beside the found ones must lie above them.
  for (int hidden = 0; hidden <= n; ++hidden) {
    const EigenModes rest = Search(comm, n_owned, of, shift).run(1, modes.shape);
    if (rest.eigenvalue.empty()) return modes;  // there are no more
    modes.next = rest.eigenvalue.front();
    const double last = modes.eigenvalue.back();
    if (modes.next >= last - hidden_below * (last - shift)) return modes;
    const auto place = std::ranges::upper_bound(modes.eigenvalue, modes.next) - modes.eigenvalue.begin();
    modes.eigenvalue.insert(modes.eigenvalue.begin() + place, modes.next);
    modes.shape.insert(modes.shape.begin() + place, rest.shape.front());
    keep(modes, std::size_t(n));
  }
  throw SolveFailure(
      "Cannot verify the {} lowest modes: further ones keep appearing below them. Request fewer modes or "
      "refine the mesh.",
      n);
}

}  // namespace couplet::modes
