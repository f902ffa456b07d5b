// SPDX-License-Identifier: Apache-2.0
#include "common/linalg/krylov.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <utility>

#include "common/base/error.hpp"
#include "common/linalg/matrix.hpp"
#include "common/linalg/petsc.hpp"
#include "common/linalg/residual_projection.hpp"
#include "common/log/log.hpp"
#include "common/log/progress.hpp"

namespace couplet::linalg {
namespace {

struct Goal {
  double residual;
  int most;  // maximum number of iterations
};

/// Preconditioned conjugate gradients [hestenes1952] in the flexible form of Polak and Ribiere, which
/// tolerates a single-precision preconditioner. Updates `x` and its residual `r`. Stops at nonpositive
/// curvature, as Newton's method requires (KSPFCG continues, KSPCG is not flexible). Returns the iterations.
int conjugate_gradients(MPI_Comm comm, const LinearMap& apply, const LinearMap& precondition,
                        std::span<double> r, std::span<double> x, const Goal& goal) {
  const std::size_t n = r.size();
  std::vector<double> z(n), v(n);
  precondition(r, z);
  std::vector<double> p = z;
  double rz = over_ranks<1>(comm, {dot_here(r, z)})[0];
  for (int k = 1; k <= goal.most; ++k) {
    log::alive();
    apply(p, v);
    const double curvature = over_ranks<1>(comm, {dot_here(p, v)})[0];
    const double alpha = rz / curvature;
    if (!(curvature > 0) || !std::isfinite(alpha)) return k;
    for (std::size_t i = 0; i < n; ++i) {
      x[i] += alpha * p[i];
      r[i] -= alpha * v[i];
    }
    if (std::sqrt(over_ranks<1>(comm, {dot_here(r, r)})[0]) <= goal.residual) return k;
    precondition(r, z);
    const auto [next, change] = over_ranks<2>(comm, {dot_here(r, z), dot_here(v, z)});
    const double beta = -alpha * change / rz;  // z . (r - r_before) / (z . r)_before
    rz = next;
    for (std::size_t i = 0; i < n; ++i) p[i] = z[i] + beta * p[i];
  }
  return goal.most;
}

/// BiCGStab [vandervorst1992] with right preconditioning. Updates `x` and its residual `r` and returns the
/// number of iterations. With PETSc's KSPBCGS a step of bent-beam had to be halved.
int bicgstab(MPI_Comm comm, const LinearMap& apply, const LinearMap& precondition, std::span<double> r,
             std::span<double> x, const Goal& goal) {
  const std::size_t n = r.size();
  const std::vector<double> shadow(r.begin(), r.end());
  std::vector<double> p = shadow, v(n), t(n), z(n);
  double rho = over_ranks<1>(comm, {dot_here(r, r)})[0];
  for (int k = 1; k <= goal.most; ++k) {
    log::alive();
    precondition(p, z);
    apply(z, v);
    const double alpha = rho / over_ranks<1>(comm, {dot_here(shadow, v)})[0];
    if (!std::isfinite(alpha)) return k;
    for (std::size_t i = 0; i < n; ++i) {
      x[i] += alpha * z[i];
      r[i] -= alpha * v[i];
    }
    if (std::sqrt(over_ranks<1>(comm, {dot_here(r, r)})[0]) <= goal.residual) return k;
    precondition(r, z);
    apply(z, t);
    const auto [tr, tt] = over_ranks<2>(comm, {dot_here(t, r), dot_here(t, t)});
    if (tt == 0) return k;
    const double omega = tr / tt;
    for (std::size_t i = 0; i < n; ++i) {
      x[i] += omega * z[i];
      r[i] -= omega * t[i];
    }
    const auto [next, rr] = over_ranks<2>(comm, {dot_here(shadow, r), dot_here(r, r)});
    if (std::sqrt(rr) <= goal.residual) return k;
    const double beta = next / rho * (alpha / omega);
    if (!std::isfinite(beta) || beta == 0) return k;
    rho = next;
    for (std::size_t i = 0; i < n; ++i) p[i] = r[i] + beta * (p[i] - omega * v[i]);
  }
  return goal.most;
}

// A residual below this multiple of the round-off in A x cannot be reduced further.
constexpr double at_rounding = 10;

}  // namespace

KrylovSolver::KrylovSolver(std::string what, MPI_Comm comm, std::size_t n, LinearMap apply,
                           LinearMap precondition)
    : what_(std::move(what)),
      comm_(comm),
      n_(n),
      apply_(std::move(apply)),
      precondition_(std::move(precondition)) {}

KrylovSolver::~KrylovSolver() = default;

void KrylovSolver::forget_vectors() {
  r_ = std::vector<double>();
  gmres_.reset();
}

/// Computes r = b - A x and returns its norm.
double KrylovSolver::true_residual(std::span<const double> b, std::span<const double> x) {
  apply_(x, r_);
  for (std::size_t i = 0; i < r_.size(); ++i) r_[i] = b[i] - r_[i];
  return std::sqrt(over_ranks<1>(comm_, {dot_here(r_, r_)})[0]);
}

/// Norm of A (3 x) / 3 - A x, which is pure round-off.
double KrylovSolver::rounding(std::span<const double> x) {
  std::vector<double> thrice(n_), of_thrice(n_), once(n_);
  for (std::size_t i = 0; i < n_; ++i) thrice[i] = 3 * x[i];
  apply_(thrice, of_thrice);
  apply_(x, once);
  for (std::size_t i = 0; i < n_; ++i) once[i] -= of_thrice[i] / 3;
  return std::sqrt(over_ranks<1>(comm_, {dot_here(once, once)})[0]);
}

SolveStatistics KrylovSolver::solve(std::span<const double> b, std::span<double> x,
                                    const KrylovOptions& options, ResidualProjection* projection) {
  const auto start = std::chrono::steady_clock::now();
  SolveStatistics statistics;
  r_.resize(n_);
  const double size = std::sqrt(over_ranks<1>(comm_, {dot_here(b, b)})[0]);
  // Below 1e-150 squares underflow, so norms are not reliable (a motion that has decayed).
  const double wanted = std::max({options.relative_tolerance * size, options.absolute_tolerance, 1e-150});
  statistics.residual = true_residual(b, x);
  // Comparisons with NaN are false, so that NaN would count as converged.
  if (!std::isfinite(size) || !std::isfinite(statistics.residual))
    throw SolveFailure("The Krylov solver for {}: {} is not finite.", what_,
                       std::isfinite(size) ? "the initial guess" : "the right-hand side");
  bool is_true = true;
  if (projection && projection->project(r_, x)) {
    statistics.residual = std::sqrt(over_ranks<1>(comm_, {dot_here(r_, r_)})[0]);
    is_true = statistics.residual <= wanted;
    if (is_true) statistics.residual = true_residual(b, x);
  }
  // A restart without progress means that round-off, not the method, is the limit.
  double before = std::numeric_limits<double>::infinity();
  bool is_hard = options.is_hard;
  while (!(statistics.residual <= wanted)) {
    bool stuck = statistics.residual > 0.9 * before;
    if (stuck && statistics.residual < at_rounding * rounding(x)) break;
    if (!is_hard && !options.is_symmetric && (stuck || statistics.iterations >= options.patience)) {
      is_hard = true;
      stuck = false;
    }
    if (stuck || statistics.iterations >= options.max_iterations || !std::isfinite(statistics.residual))
      throw SolveFailure(
          "The Krylov solver for {} did not converge: {} reached a relative residual of {:.3e} (tolerance "
          "{:.3e}) in {} of at most {} iterations{}.",
          what_,
          options.is_symmetric ? "CG"
          : options.is_hard    ? "GMRES"
          : is_hard            ? "GMRES after BiCGStab"
                               : "BiCGStab",
          statistics.residual / size, options.relative_tolerance, statistics.iterations,
          options.max_iterations, stuck ? " and a restart does not help" : "");
    // Aims lower near the goal, so that a small reduction does not count as no progress.
    const bool is_near = std::isfinite(before) && statistics.residual < 2 * wanted;
    const double aim = is_near ? wanted / 2 : wanted;
    before = statistics.residual;
    const int earlier = statistics.iterations;
    const bool is_bicgstab = !options.is_symmetric && !is_hard;
    const std::vector<double> start_of_it(x.begin(), is_bicgstab ? x.end() : x.begin());
    if (options.is_symmetric)
      statistics.iterations +=
          conjugate_gradients(comm_, apply_, precondition_, r_, x, {aim, options.max_iterations - earlier});
    else if (is_bicgstab)
      statistics.iterations += bicgstab(comm_, apply_, precondition_, r_, x,
                                        {aim, std::min(options.max_iterations, options.patience) - earlier});
    else
      statistics.iterations += run_gmres(x, aim, options.max_iterations - earlier, earlier > 0);
    const bool keep = options.is_symmetric && is_true && statistics.iterations - earlier <= options.carried;
    statistics.residual = keep ? std::sqrt(over_ranks<1>(comm_, {dot_here(r_, r_)})[0]) : true_residual(b, x);
    if (is_bicgstab && !(statistics.residual <= before)) {
      // Discards a correction that increased the residual. GMRES starts where BiCGStab did.
      std::ranges::copy(start_of_it, x.begin());
      statistics.residual = true_residual(b, x);
    }
    is_true = true;
  }
  if (projection) projection->finish(r_, x);
  statistics.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return statistics;
}

/// Counts two applications as one iteration, as in BiCGStab.
int KrylovSolver::run_gmres(std::span<double> x, double wanted, int most, bool continues) {
  if (!is_announced_ && continues) log::info("{}: BiCGStab did not converge; continuing with GMRES", what_);
  is_announced_ = true;
  if (!gmres_) gmres_ = std::make_unique<PetscGmres>(comm_, n_, apply_, precondition_);
  return (gmres_->run(r_, x, wanted, 2 * most) + 1) / 2;
}

}  // namespace couplet::linalg
