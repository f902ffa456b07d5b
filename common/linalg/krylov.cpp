// SPDX-License-Identifier: Apache-2.0
#include "common/linalg/krylov.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <limits>
#include <utility>

#include "common/base/error.hpp"
#include "common/linalg/dot.hpp"
#include "common/linalg/petsc_shell.hpp"
#include "common/linalg/residual_projection.hpp"
#include "common/log/log.hpp"
#include "common/log/progress.hpp"

namespace couplet::linalg {
namespace {

// A residual below so many times the difference that rounding makes in A x is as small as it gets.
constexpr double at_rounding = 10;
// Iterations of BiCGStab after which the spectrum is taken to be one that it is slow on.
constexpr int patience = 50;

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
  for (auto* v : {&r_, &shadow_, &p_, &v_, &t_, &z_}) *v = std::vector<double>();
  gmres_.reset();
}

/// r = b - A x and its norm.
double KrylovSolver::true_residual(std::span<const double> b, std::span<const double> x) {
  apply_(x, r_);
  for (std::size_t i = 0; i < r_.size(); ++i) r_[i] = b[i] - r_[i];
  return std::sqrt(over_ranks<1>(comm_, {dot_here(r_, r_)})[0]);
}

/// Norm of A (3 x) / 3 - A x: nothing else than what rounding leaves undetermined.
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
  // Below that the squares of what is left underflow, and no norm is right any more: a motion that has died away.
  const double wanted = std::max(options.relative_tolerance * size, 1e-150);
  statistics.residual = true_residual(b, x);
  // Every comparison with a NaN is false, so that it would count as converged.
  if (!std::isfinite(size) || !std::isfinite(statistics.residual))
    throw SolveFailure("The Krylov solver for {}: {} is not finite.", what_,
                       std::isfinite(size) ? "the initial guess" : "the right-hand side");
  bool is_true = true;
  if (projection && projection->project(r_, x)) {
    statistics.residual = std::sqrt(over_ranks<1>(comm_, {dot_here(r_, r_)})[0]);
    is_true = statistics.residual <= wanted;
    if (is_true) statistics.residual = true_residual(b, x);
  }
  // A restart that gains nothing means that rounding, not the method, sets the limit.
  double before = std::numeric_limits<double>::infinity();
  bool is_hard = options.is_hard;
  while (!(statistics.residual <= wanted)) {
    bool stuck = statistics.residual > 0.9 * before;
    if (stuck && statistics.residual < at_rounding * rounding(x)) break;
    if (!is_hard && !options.is_symmetric && (stuck || statistics.iterations >= patience)) {
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
    // A start that is nearly there already would end a hair further on, which is not what "gains nothing" means.
    const bool is_near = std::isfinite(before) && statistics.residual < 2 * wanted;
    const double aim = is_near ? wanted / 2 : wanted;
    before = statistics.residual;
    const int earlier = statistics.iterations;
    if (options.is_symmetric)
      run_cg(x, aim, options.max_iterations, statistics);
    else if (is_hard)
      run_gmres(x, aim, options.max_iterations, statistics);
    else
      try_bicgstab(x, aim, std::min(options.max_iterations, patience), statistics);
    const bool keep = options.is_symmetric && is_true && statistics.iterations - earlier <= options.carried;
    statistics.residual = keep ? std::sqrt(over_ranks<1>(comm_, {dot_here(r_, r_)})[0]) : true_residual(b, x);
    is_true = true;
  }
  if (projection) projection->finish(r_, x);
  statistics.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return statistics;
}

/// Preconditioned conjugate gradients in the flexible form of Polak and Ribiere, which forgives a
/// preconditioner that rounds to single precision.
void KrylovSolver::run_cg(std::span<double> x, double wanted, int max_iterations,
                          SolveStatistics& statistics) {
  const std::size_t n = r_.size();
  for (auto* v : {&p_, &v_, &z_}) v->resize(n);
  precondition_(r_, z_);
  p_ = z_;
  double rz = over_ranks<1>(comm_, {dot_here(r_, z_)})[0];
  while (statistics.iterations < max_iterations) {
    log::alive();
    ++statistics.iterations;
    apply_(p_, v_);
    const double curvature = over_ranks<1>(comm_, {dot_here(p_, v_)})[0];
    const double alpha = rz / curvature;
    if (!(curvature > 0) || !std::isfinite(alpha)) return;
    for (std::size_t i = 0; i < n; ++i) {
      x[i] += alpha * p_[i];
      r_[i] -= alpha * v_[i];
    }
    if (std::sqrt(over_ranks<1>(comm_, {dot_here(r_, r_)})[0]) <= wanted) return;
    precondition_(r_, z_);
    const auto [next, change] = over_ranks<2>(comm_, {dot_here(r_, z_), dot_here(v_, z_)});
    const double beta = -alpha * change / rz;  // z . (r - r_before) / (z . r)_before
    rz = next;
    for (std::size_t i = 0; i < n; ++i) p_[i] = z_[i] + beta * p_[i];
  }
}

void KrylovSolver::run_gmres(std::span<double> x, double wanted, int max_iterations,
                             SolveStatistics& statistics) {
  if (!is_announced_ && statistics.iterations > 0)
    log::info("{}: {} iterations of BiCGStab were not enough; GMRES continues", what_, statistics.iterations);
  is_announced_ = true;
  for (auto* v : {&shadow_, &p_, &v_, &t_, &z_}) *v = std::vector<double>();
  if (!gmres_) gmres_ = std::make_unique<PetscGmres>(comm_, n_, apply_, precondition_);
  // An iteration of BiCGStab preconditions and applies twice.
  const int applications = gmres_->run(r_, x, wanted, 2 * (max_iterations - statistics.iterations));
  statistics.iterations += (applications + 1) / 2;
}

/// What leaves more than it found is undone: GMRES starts where this did.
void KrylovSolver::try_bicgstab(std::span<double> x, double wanted, int max_iterations,
                                SolveStatistics& statistics) {
  const std::vector<double> start(x.begin(), x.end());
  run_bicgstab(x, wanted, max_iterations, statistics);
  if (!(std::sqrt(over_ranks<1>(comm_, {dot_here(r_, r_)})[0]) <= statistics.residual))
    std::ranges::copy(start, x.begin());
}

void KrylovSolver::run_bicgstab(std::span<double> x, double wanted, int max_iterations,
                                SolveStatistics& statistics) {
  const std::size_t n = r_.size();
  for (auto* v : {&shadow_, &p_, &v_, &t_, &z_}) v->resize(n);
  shadow_ = r_;
  p_ = r_;
  double rho = over_ranks<1>(comm_, {dot_here(r_, r_)})[0];
  while (statistics.iterations < max_iterations) {
    log::alive();
    ++statistics.iterations;
    precondition_(p_, z_);
    apply_(z_, v_);
    const double alpha = rho / over_ranks<1>(comm_, {dot_here(shadow_, v_)})[0];
    if (!std::isfinite(alpha)) return;
    for (std::size_t i = 0; i < n; ++i) {
      x[i] += alpha * z_[i];
      r_[i] -= alpha * v_[i];
    }
    if (std::sqrt(over_ranks<1>(comm_, {dot_here(r_, r_)})[0]) <= wanted) return;
    precondition_(r_, z_);
    apply_(z_, t_);
    const auto [tr, tt] = over_ranks<2>(comm_, {dot_here(t_, r_), dot_here(t_, t_)});
    if (tt == 0) return;
    const double omega = tr / tt;
    for (std::size_t i = 0; i < n; ++i) {
      x[i] += omega * z_[i];
      r_[i] -= omega * t_[i];
    }
    const auto [next, rr] = over_ranks<2>(comm_, {dot_here(shadow_, r_), dot_here(r_, r_)});
    if (std::sqrt(rr) <= wanted) return;
    const double beta = next / rho * (alpha / omega);
    if (!std::isfinite(beta) || beta == 0) return;
    rho = next;
    for (std::size_t i = 0; i < n; ++i) p_[i] = r_[i] + beta * (p_[i] - omega * v_[i]);
  }
}

}  // namespace couplet::linalg
