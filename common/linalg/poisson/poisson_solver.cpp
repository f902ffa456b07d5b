// SPDX-License-Identifier: Apache-2.0
#include "common/linalg/poisson/poisson_solver.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <chrono>
#include <cmath>
#include <utility>

#include "common/base/error.hpp"
#include "common/linalg/dot.hpp"
#include "common/linalg/lanes/vector_passes.hpp"
#include "common/linalg/multigrid/coloured_multigrid.hpp"
#include "common/linalg/single_factors.hpp"
#include "common/log/progress.hpp"
#include "common/parallel/collective.hpp"

namespace couplet::linalg {
namespace {

constexpr int most_iterations = 500;
// As LinearSolver: fresh factors cost about as much as this many iterations save over a few dozen solves.
constexpr int most_with_kept_factors = 8;
// Fresh factors in double precision need one iteration, two at very tight tolerances: more than this many with factors in single
// precision mean that cells are too thin for them.
constexpr int most_with_new_single_factors = 6;
// Sums of rows over their diagonals: of round-off, so that x is known up to a constant; of what is small beside the faces and yet all that
// holds a constant, which multigrid in single precision would lose (a closed fluid that hardly compresses).
constexpr double round_off = 1e-13, little = 1e-5;

struct RowSums {
  double largest = 0;  ///< over the diagonal
  double all = 0;
};
/// Collective.
RowSums sums_of(const CellMatrix::Rows& rows, std::span<const double> diagonal, MPI_Comm comm) {
  RowSums sums;
  for (std::size_t c = 0; c + 1 < rows.offset.size(); ++c) {
    if (rows.offset[c] == rows.offset[c + 1]) continue;  // blocked: an equation of its own
    double sum = diagonal[c];
    for (auto e = rows.offset[c]; e < rows.offset[c + 1]; ++e) sum += rows.value[e];
    sums.largest = std::max(sums.largest, std::abs(sum) / diagonal[c]);
    sums.all += sum;
  }
  return {parallel::max(comm, sums.largest), parallel::sum(comm, sums.all)};
}

}  // namespace

PoissonSolver::PoissonSolver(std::string what, const CellGraph& graph, Preconditioner kind)
    : what_(std::move(what)), kind_(kind), matrix_(graph) {
  memory_.is_single = kind == Preconditioner::factors;
}

PoissonSolver::~PoissonSolver() = default;

void PoissonSolver::fill(std::span<const double> diagonal, std::span<const double> faces,
                         [[maybe_unused]] std::span<const double> beside) {
  assert(beside.empty());
  faces_.assign(faces.begin(), faces.end());
  matrix_.fill(diagonal, faces);
}

void PoissonSolver::make_preconditioner() {
  const log::LongWork work;
  const CellGraph& graph = matrix_.graph();
  const CellMatrix::Rows rows = matrix_.rows(faces_, kind_ == Preconditioner::factors);
  const std::vector<double>& diagonal = matrix_.diagonal();
  const Index n = graph.cells.n_owned();
  if (kind_ == Preconditioner::multigrid) {
    ColouredMultigrid::Rows single;
    single.offset = rows.offset;
    single.index = rows.index;
    single.value.assign(rows.value.begin(), rows.value.end());
    single.diagonal.assign(diagonal.begin(), diagonal.begin() + n);
    const RowSums sums = sums_of(rows, diagonal, graph.comm);
    const bool closed = sums.largest < little;
    multigrid_ = std::make_unique<ColouredMultigrid>(
        std::move(single), ColouredMultigrid::Options{1, &graph.cells, graph.comm, closed});
    constant_ = closed && sums.largest > round_off ? 1 / sums.all : 0;
    return;
  }
  std::vector<int> offset{0}, index;
  std::vector<double> value;
  for (Index c = 0; c < n; ++c) {
    const auto add = [&](Index column, double a) { index.push_back(column), value.push_back(a); };
    Index e = rows.offset[c];
    for (; e < rows.offset[c + 1] && rows.index[e] < c; ++e) add(rows.index[e], rows.value[e]);
    add(c, diagonal[c]);
    for (; e < rows.offset[c + 1]; ++e) add(rows.index[e], rows.value[e]);
    offset.push_back(static_cast<int>(index.size()));
  }
  if (!factors_) factors_ = std::make_unique<SingleFactors>();
  factors_->factorise(offset, index, value);
}

/// z = M^-1 r; `size`: |r|.
void PoissonSolver::precondition(double size) {
  const std::size_t n = matrix_.graph().cells.n_owned();
  const std::span<const double> r(r_.data(), n);
  const std::span<double> z(z_.data(), n);
  if (multigrid_) {
    multigrid_->apply(r, z, size);
    if (constant_ > 0) shift(constant_ * parallel::sum(matrix_.graph().comm, sum_of(r)), z);
  } else if (memory_.is_single)
    factors_->apply(r, z);
  else
    factors_->apply_double(r, z);
}

void PoissonSolver::restore(const PreconditionerMemory& memory) {
  memory_ = memory;
  if (!memory_.is_due) make_preconditioner();
}

double PoissonSolver::norm(std::span<const double> values) const {
  return std::sqrt(over_ranks<1>(matrix_.graph().comm, {sum_of_squares(values)})[0]);
}

/// r = b - A x.
void PoissonSolver::start(std::span<const double> b, std::span<const double> x) {
  const parallel::IndexMap& cells = matrix_.graph().cells;
  const std::size_t room = with_room(cells.n_local());
  for (auto* v : {&r_, &p_, &q_, &z_}) v->resize(room, 0.0);
  std::ranges::copy(x.first(cells.n_owned()), p_.begin());
  cells.update_ghosts(std::span(p_).first(cells.n_local()));
  matrix_.multiply(p_.data(), q_.data());
  for (std::size_t i = 0; i < b.size(); ++i) r_[i] = b[i] - q_[i];
}

double PoissonSolver::true_residual(std::span<const double> b, std::span<const double> x) {
  start(b, x);
  return norm(std::span<const double>(r_).first(b.size()));
}

/// In the flexible form of Polak and Ribiere, which forgives a preconditioner that rounds to single precision.
bool PoissonSolver::iterate(std::span<double> x, const Goal& goal, SolveStatistics& statistics) {
  const CellGraph& graph = matrix_.graph();
  const std::size_t n = graph.cells.n_owned();
  const std::span<double> p(p_.data(), n), z(z_.data(), n);
  const std::span<const double> q(q_.data(), n);
  double rz = 0;
  for (int k = 0; k < goal.most; ++k) {
    log::alive();
    precondition(statistics.residual);
    double beta = 0;
    if (k > 0) {  // q = (r_before - r) / alpha
      const auto [now, change] = over_ranks<2>(graph.comm, two_products(z, {r_.data(), n}, q));
      beta = -change * rz_step_ / rz;
      rz = now;
    } else {
      rz = over_ranks<1>(graph.comm, {two_products(z, {r_.data(), n}, q)[0]})[0];
    }
    turn(beta, z, p);
    graph.cells.update_ghosts(std::span(p_).first(graph.cells.n_local()));
    const double curvature = over_ranks<1>(graph.comm, {matrix_.multiply(p_.data(), q_.data())})[0];
    rz_step_ = rz / curvature;
    if (!(curvature > 0) || !std::isfinite(rz_step_)) return false;
    statistics.residual =
        std::sqrt(over_ranks<1>(graph.comm, {go_along(rz_step_, p, q, x, {r_.data(), n})})[0]);
    ++statistics.iterations;
    if (!std::isfinite(statistics.residual)) return false;
    if (statistics.residual <= goal.residual) return true;
  }
  return false;
}

bool PoissonSolver::attempt(std::span<const double> b, std::span<double> x, const Goal& goal,
                            SolveStatistics& statistics) {
  if (memory_.is_due) make_preconditioner();
  statistics.residual = true_residual(b, x);
  if (statistics.residual <= goal.residual) return true;
  const bool reached = std::isfinite(statistics.residual) && iterate(x, goal, statistics);
  if (!reached) {  // what is not finite stays in none of these
    for (auto* v : {&r_, &p_, &q_, &z_}) v->clear();
    multigrid_.reset();
  }
  return reached;
}

SolveStatistics PoissonSolver::solve(std::span<const double> b, std::span<double> x, double relative,
                                     double absolute) {
  const auto begin = std::chrono::steady_clock::now();
  SolveStatistics statistics;
  const Goal goal{std::max(relative > 0 ? relative * norm(b) : 0, absolute), most_iterations};
  bool reached = attempt(b, x, goal, statistics);
  if (!reached && (!memory_.is_due || memory_.is_single)) {
    // The kept preconditioner no longer fits the matrix: one more try with a fresh one.
    if (memory_.is_due) memory_.is_single = false;
    memory_.is_due = true;
    std::fill(x.begin(), x.end(), 0.0);
    reached = attempt(b, x, goal, statistics);
  }
  if (!reached) {
    memory_.is_due = true;
    throw SolveFailure(
        "The linear solver for {} did not converge: after {} iterations the residual is {:.3e}.", what_,
        statistics.iterations, statistics.residual);
  }
  if (memory_.is_due) {
    memory_.is_due = false;
    ++built_;
    memory_.most_iterations =
        kind_ == Preconditioner::factors ? most_with_kept_factors : 2 * statistics.iterations + 2;
    if (memory_.is_single && statistics.iterations > most_with_new_single_factors) {
      memory_.is_single = false;
      memory_.is_due = true;
    }
  } else if (statistics.iterations > memory_.most_iterations) {
    memory_.is_due = true;
  }
  statistics.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  return statistics;
}

}  // namespace couplet::linalg
