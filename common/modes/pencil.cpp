// SPDX-License-Identifier: Apache-2.0
#include "common/modes/pencil.hpp"

#include <slepceps.h>

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <exception>
#include <numeric>

#include "common/base/error.hpp"
#include "common/linalg/petsc.hpp"
#include "common/linalg/symmetric_factors.hpp"
#include "common/parallel/collective.hpp"

namespace couplet::modes {
namespace {

using linalg::petsc_check;

// Additional modes, so that the shift for counting can be placed between two eigenvalues.
constexpr int extra = 4;
// Relative tolerances of eigenvalues of the inverse, with factors or another solver.
constexpr double with_factors = 1e-12, with_solver = 1e-9;
// A mode hidden from the first search lies below the last one by more than round-off.
constexpr double hidden_below = 1e-6;

/// Starts SLEPc, which PETSc finalizes.
void start_slepc() {
  if (SlepcInitializeCalled) return;
  petsc_check(SlepcInitializeNoArguments());
  petsc_check(PetscRegisterFinalize(SlepcFinalize));
}

/// One search by SLEPc with its operators.
class Search {
 public:
  explicit Search(const Pencil& pencil) : n_(pencil.n), pencil_(pencil) {
    start_slepc();
    k_ = linalg::symmetric_shell(pencil_.comm, n_, stiffness_);
    m_ = linalg::symmetric_shell(pencil_.comm, n_, mass_);
    petsc_check(EPSCreate(pencil_.comm, &eps_));
    petsc_check(EPSSetOperators(eps_, k_, m_));
    petsc_check(EPSSetProblemType(eps_, EPS_GHEP));
  }
  Search(const Search&) = delete;
  Search& operator=(const Search&) = delete;
  ~Search() {
    if (std::uncaught_exceptions() > 0) return;  // collective: not during unwinding
    EPSDestroy(&eps_);
    MatDestroy(&k_);
    MatDestroy(&m_);
  }

  EPS eps() const { return eps_; }

  /// Selects Krylov-Schur.
  void set_method(EPSWhich which, STType transformation) {
    petsc_check(EPSSetType(eps_, EPSKRYLOVSCHUR));
    petsc_check(EPSSetWhichEigenpairs(eps_, which));
    ST st = nullptr;
    KSP ksp = nullptr;
    PC pc = nullptr;
    petsc_check(EPSGetST(eps_, &st));
    petsc_check(STSetType(st, transformation));
    petsc_check(STSetMatMode(st, ST_MATMODE_SHELL));
    petsc_check(STGetKSP(st, &ksp));
    petsc_check(KSPSetType(ksp, KSPPREONLY));
    petsc_check(KSPGetPC(ksp, &pc));
    petsc_check(PCSetType(pc, PCSHELL));
    petsc_check(PCShellSetContext(pc, &inverse_));
    petsc_check(PCShellSetApply(pc, linalg::precondition_shell));
  }

  /// Excludes known modes from the search.
  void leave_out(std::span<const std::vector<double>> found) {
    std::vector<::Vec> vectors(found.size());
    for (std::size_t i = 0; i < found.size(); ++i) {
      petsc_check(MatCreateVecs(k_, &vectors[i], nullptr));
      double* entries = nullptr;
      petsc_check(VecGetArray(vectors[i], &entries));
      std::ranges::copy(found[i], entries);
      petsc_check(VecRestoreArray(vectors[i], &entries));
    }
    if (!found.empty()) petsc_check(EPSSetDeflationSpace(eps_, PetscInt(found.size()), vectors.data()));
    for (::Vec& v : vectors) petsc_check(VecDestroy(&v));
  }

  /// Searches for `n` modes and returns the converged ones in SLEPc's order. Exceptions of the operators are
  /// thrown on every rank, because the operators are collective.
  EigenModes run(GlobalIndex n, double tolerance, int restarts, double shift = 0) {
    petsc_check(EPSSetDimensions(eps_, PetscInt(n), PETSC_DEFAULT, PETSC_DEFAULT));
    petsc_check(EPSSetTolerances(eps_, tolerance, restarts));
    petsc_check(EPSSolve(eps_));
    if (failure_) std::rethrow_exception(failure_);
    PetscInt found = 0;
    petsc_check(EPSGetConverged(eps_, &found));
    EigenModes modes;
    ::Vec x = nullptr;
    std::vector<double> force(n_), inertia(n_);
    petsc_check(MatCreateVecs(k_, &x, nullptr));
    for (PetscInt i = 0; i < found; ++i) {
      double value = 0;
      const double* entries = nullptr;
      petsc_check(EPSGetEigenpair(eps_, i, &value, nullptr, x, nullptr));
      petsc_check(VecGetArrayRead(x, &entries));
      modes.eigenvalue.push_back(value);
      modes.shape.emplace_back(entries, entries + n_);
      petsc_check(VecRestoreArrayRead(x, &entries));
      pencil_.k(modes.shape.back(), force);
      pencil_.m(modes.shape.back(), inertia);
      double residual = 0, size = 0;
      for (std::size_t r = 0; r < n_; ++r) {
        residual += (force[r] - value * inertia[r]) * (force[r] - value * inertia[r]);
        size += inertia[r] * inertia[r];
      }
      residual = std::sqrt(parallel::sum(pencil_.comm, residual) / parallel::sum(pencil_.comm, size));
      modes.worst_residual = std::max(modes.worst_residual, residual / std::abs(value - shift));
    }
    petsc_check(VecDestroy(&x));
    return modes;
  }

 private:
  std::size_t n_;
  const Pencil& pencil_;
  std::exception_ptr failure_;
  linalg::ShellOperator stiffness_{&pencil_.k, &failure_}, mass_{&pencil_.m, &failure_},
      inverse_{&pencil_.solve, &failure_};
  Mat k_ = nullptr, m_ = nullptr;
  EPS eps_ = nullptr;
};

void keep(EigenModes& modes, std::size_t n) {
  modes.eigenvalue.resize(n);
  modes.shape.resize(n);
}

/// The `n` modes closest to the shift in ascending order, without the given ones.
EigenModes nearest(const Pencil& pencil, GlobalIndex n, double shift, double tolerance,
                   std::span<const std::vector<double>> beside = {}) {
  Search search(pencil);
  search.set_method(EPS_TARGET_MAGNITUDE, STSINVERT);
  petsc_check(EPSSetTarget(search.eps(), shift));
  search.leave_out(beside);
  EigenModes found = search.run(n, tolerance, 500, shift), modes;
  modes.worst_residual = found.worst_residual;
  std::vector<std::size_t> order(found.eigenvalue.size());
  std::iota(order.begin(), order.end(), 0);
  std::ranges::stable_sort(order, {}, [&](std::size_t i) { return found.eigenvalue[i]; });
  for (const std::size_t i : order) {
    modes.eigenvalue.push_back(found.eigenvalue[i]);
    modes.shape.push_back(std::move(found.shape[i]));
  }
  return modes;
}

/// Number of modes, at least `n`, that end at the widest relative gap of the last ones.
int widest_gap(const std::vector<double>& values, int n, double shift) {
  int best = n;
  double widest = -1;
  for (int i = n; i < static_cast<int>(values.size()); ++i) {
    const double gap = (values[i] - values[i - 1]) / (values[i] - shift);
    if (gap > widest) widest = gap, best = i;
  }
  return best;
}

EigenModes counted_modes(const Pencil& pencil, int n, double shift,
                         const std::function<GlobalIndex(double)>& count_below) {
  // One Krylov space may miss members of a group of equal eigenvalues, so it retries with more modes.
  const GlobalIndex rows = parallel::sum(pencil.comm, GlobalIndex(pencil.n));
  for (int more = extra; more <= 8 * extra; more *= 2) {
    EigenModes modes = nearest(pencil, std::min<GlobalIndex>(n + more, rows), shift, with_factors);
    if (static_cast<int>(modes.eigenvalue.size()) <= n) continue;
    const int end = widest_gap(modes.eigenvalue, n, shift);
    if (count_below(0.5 * (modes.eigenvalue[end - 1] + modes.eigenvalue[end])) != end) continue;
    modes.next = modes.eigenvalue[n];
    keep(modes, std::size_t(n));
    return modes;
  }
  throw SolveFailure(
      "Cannot verify the {} lowest modes: the eigenvalue solver returned fewer modes, or modes other than those that the pivot "
      "count predicts. Check that the model is connected and its stiffness is positive definite, or request fewer modes.",
      n);
}

}  // namespace

EigenModes lowest_modes(const Pencil& pencil, int n, double shift,
                        const std::function<GlobalIndex(double)>& count_below) {
  if (count_below) return counted_modes(pencil, n, shift, count_below);
  EigenModes modes = nearest(pencil, n, shift, with_solver);
  if (static_cast<int>(modes.eigenvalue.size()) < n)
    throw SolveFailure("Only {} of {} modes were found. Request fewer modes or refine the mesh.",
                       modes.eigenvalue.size(), n);
  keep(modes, std::size_t(n));
  for (int hidden = 0; hidden <= n; ++hidden) {
    const EigenModes rest = nearest(pencil, 1, shift, with_solver, modes.shape);
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
      "Cannot verify the {} lowest modes: further ones keep appearing below them. Request fewer modes or refine the mesh.",
      n);
}

EigenModes lowest_modes(const linalg::SparseMatrix& stiffness, const linalg::SparseMatrix& mass, int n,
                        double shift) {
  const GlobalIndex rows = parallel::sum(stiffness.comm(), stiffness.n_owned_rows());
  if (n > rows)
    throw Error(
        "{} modes are requested, but the model has only {} unknowns. Request fewer modes or refine the model.",
        n, rows);
  const linalg::SymmetricFactors factors(stiffness, mass, shift);
  const Pencil pencil{.comm = stiffness.comm(),
                      .n = std::size_t(stiffness.n_owned_rows()),
                      .k = [&](std::span<const double> x, std::span<double> y) { stiffness.multiply(x, y); },
                      .m = [&](std::span<const double> x, std::span<double> y) { mass.multiply(x, y); },
                      .solve = [&](std::span<const double> x, std::span<double> y) { factors.solve(x, y); }};
  return lowest_modes(pencil, n, shift, [&](double s) {
    return linalg::SymmetricFactors(stiffness, mass, s).negative_pivots();
  });
}

EigenModes largest_modes(const Pencil& pencil, int n) {
  Search search(pencil);
  search.set_method(EPS_LARGEST_REAL, STSHIFT);
  const GlobalIndex rows = parallel::sum(pencil.comm, GlobalIndex(pencil.n));
  EigenModes modes = search.run(std::min<GlobalIndex>(n, rows), with_solver, 100);
  keep(modes, std::min(modes.eigenvalue.size(), std::size_t(n)));
  return modes;
}

namespace {

// Fraction of a direction that round-off leaves in another one.
constexpr double left_of_direction = 1e-10;

Eigen::VectorXd times(const linalg::LinearMap& map, const Eigen::VectorXd& x) {
  Eigen::VectorXd y(x.size());
  map({x.data(), std::size_t(x.size())}, {y.data(), std::size_t(y.size())});
  return y;
}

/// Vector x with K x and M x.
struct Direction {
  Eigen::VectorXd x, k, m;
  void multiply(const Pencil& pencil) {
    k = times(pencil.k, x);
    m = times(pencil.m, x);
  }
  void add(double factor, const Direction& other) {
    x += factor * other.x, k += factor * other.k, m += factor * other.m;
  }
  void scale(double factor) { x *= factor, k *= factor, m *= factor; }
};

double dot(const Pencil& pencil, const Eigen::VectorXd& a, const Eigen::VectorXd& b) {
  return parallel::sum(pencil.comm, a.dot(b));
}

/// Normalizes with respect to M, orthogonal to the others. Returns false if nothing is left.
bool normalize(const Pencil& pencil, Direction& d, std::initializer_list<const Direction*> others) {
  const double before = dot(pencil, d.x, d.m);
  if (!(before > 0)) return false;
  for (int twice = 0; twice < 2; ++twice)
    for (const Direction* other : others) d.add(-dot(pencil, d.x, other->m), *other);
  const double square = dot(pencil, d.x, d.m);
  if (!(square > left_of_direction * left_of_direction * before)) return false;
  d.scale(1 / std::sqrt(square));
  return true;
}

}  // namespace

LowestQuotient lowest_quotient(const Pencil& pencil, const std::vector<double>& start, int most_iterations,
                               const std::function<bool(const std::vector<double>&)>& enough) {
  LowestQuotient result;
  Direction x{Eigen::Map<const Eigen::VectorXd>(start.data(), std::ssize(start)), {}, {}}, w, p;
  x.multiply(pencil);
  if (!normalize(pencil, x, {})) return result;
  std::vector<double> values;
  bool has_p = false;
  for (; result.iterations < most_iterations; ++result.iterations) {
    values.push_back(dot(pencil, x.x, x.k));
    if (result.iterations > 0 && enough(values)) break;
    w.x = times(pencil.solve, x.k - values.back() * x.m);
    w.multiply(pencil);
    has_p = has_p && normalize(pencil, p, {&x});
    if (!(has_p ? normalize(pencil, w, {&x, &p}) : normalize(pencil, w, {&x}))) break;
    const std::array<const Direction*, 3> all{&x, &w, &p};
    const int size = has_p ? 3 : 2;
    Eigen::MatrixXd small(size, size);
    for (int i = 0; i < size; ++i)
      for (int j = 0; j <= i; ++j)
        small(i, j) = small(j, i) = dot(pencil, all[std::size_t(i)]->x, all[std::size_t(j)]->k);
    const Eigen::VectorXd best = Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(small).eigenvectors().col(0);
    Direction step = w;
    step.scale(best[1]);
    if (has_p) step.add(best[2], p);
    x.scale(best[0]);
    x.add(1, step);
    p = std::move(step);
    has_p = true;
  }
  result.value = values.empty() ? 0 : values.back();
  result.x.assign(x.x.begin(), x.x.end());
  return result;
}

Curvature find_negative_curvature(MPI_Comm comm, const linalg::LinearMap& a,
                                  const linalg::LinearMap& precondition, std::span<const double> b,
                                  double tolerance, int most_iterations) {
  const std::size_t n = b.size();
  const auto dot = [&](std::span<const double> x, std::span<const double> y) {
    return parallel::sum(comm, std::inner_product(x.begin(), x.end(), y.begin(), 0.0));
  };
  Curvature result;
  result.x.assign(n, 0);
  std::vector<double> r(b.begin(), b.end()), z(n), p, q(n);
  const double wanted = tolerance * std::sqrt(dot(r, r));
  double along = 0;
  for (; result.iterations < most_iterations; ++result.iterations) {
    precondition(r, z);
    const double next = dot(r, z);
    if (p.empty())
      p = z;
    else
      for (std::size_t i = 0; i < n; ++i) p[i] = z[i] + next / along * p[i];
    along = next;
    a(p, q);
    const double curvature = dot(p, q);
    if (!(curvature > 0)) {
      result.is_negative = curvature < 0;
      if (result.is_negative) result.x = std::move(p);
      return result;
    }
    const double step = along / curvature;
    for (std::size_t i = 0; i < n; ++i) result.x[i] += step * p[i], r[i] -= step * q[i];
    if (std::sqrt(dot(r, r)) <= wanted) break;
  }
  return result;
}

bool cuts_a_group(const EigenModes& modes, double tolerance) {
  return !modes.eigenvalue.empty() && modes.next - modes.eigenvalue.back() < tolerance * std::abs(modes.next);
}

}  // namespace couplet::modes
