// SPDX-License-Identifier: Apache-2.0
#include "fluid_solver/pressure/pressure.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>

#include "common/base/error.hpp"
#include "common/parallel/collective.hpp"
#include "fluid_solver/state/state.hpp"

namespace couplet::fluid {

// Up to this size, stored Cholesky factors are faster than multigrid in 2-D, also with thin cells.
constexpr GlobalIndex largest_direct = 120000;

namespace {

constexpr double side_rounding = 1e-13;  // of a right-hand side, over its norm

Eigen::Map<Eigen::VectorXd> as_vector(std::span<double> v) { return {v.data(), std::ssize(v)}; }
Eigen::Map<const Eigen::VectorXd> as_vector(std::span<const double> v) { return {v.data(), std::ssize(v)}; }

}  // namespace

template <int D>
PressureEquation<D>::PressureEquation(const mesh::Mesh& mesh, const Boundary<D>& boundary, bool fixed)
    : mesh_(mesh),
      boundary_(boundary),
      fixed_(fixed),
      direct_(D == 2 && mesh.cells.n_global() <= largest_direct) {}

template <int D>
void PressureEquation<D>::make_solver() {
  const linalg::CellGraph graph{mesh_.cells, mesh_.comm,
                                std::span<const Index>(mesh_.owner).first(mesh_.n_interior),
                                std::span<const Index>(mesh_.neighbour).first(mesh_.n_interior)};
  using Preconditioner = linalg::CellSolver::Preconditioner;
  solver_ = std::make_unique<linalg::CellSolver>(
      "pressure", graph, direct_ ? Preconditioner::factors : Preconditioner::multigrid);
  pinned_ = direct_;
}

template <int D>
std::vector<double> PressureEquation<D>::diagonal(const Placement<D>& at, const Diagonal& added) const {
  const Index owned = mesh_.cells.n_owned();
  std::vector<double> sum(owned, 0.0);
  for (Index f = 0; f < mesh_.n_interior; ++f)
    for (const Index cell : {mesh_.owner[f], mesh_.neighbour[f]})
      if (cell < owned) sum[cell] += at.conductance[f];
  for (const Index b : boundary_.rows().of_pressure)
    sum[mesh_.owner[mesh_.n_interior + b]] += at.conductance[mesh_.n_interior + b];
  for (std::size_t b = 0; b < added.faces.size(); ++b)
    sum[mesh_.owner[mesh_.n_interior + static_cast<Index>(b)]] += added.faces[b];
  for (std::size_t c = 0; c < added.cells.size(); ++c) sum[c] += added.cells[c];
  for (double& value : sum)
    if (value == 0) value = 1;  // inside a body: p = 0 there
  if (singular() && pinned_ && owned > 0 && mesh_.cells.first() == 0) sum[0] *= 2;
  return sum;
}

template <int D>
void PressureEquation<D>::fill(std::span<const double> coefficients) {
  const std::size_t owned = mesh_.cells.n_owned(), faces = mesh_.n_interior;
  solver_->fill(coefficients.first(owned), coefficients.subspan(owned, faces));
}

template <int D>
void PressureEquation<D>::save(io::CheckpointWriter& file) const {
  if (fixed_) return;
  linalg::PreconditionerMemory memory = accepted_.memory;
  io::Archive(file).common("pressure-preconditioner-memory", memory.is_due, memory.most_iterations);
  const std::span<const double> all = *accepted_.made_from;  // nothing, or the diagonal, then the faces
  const std::size_t owned = all.empty() ? 0 : std::size_t(mesh_.cells.n_owned());
  file.write(mesh::Entries::owned_cells, "pressure-preconditioner", all.first(owned));
  const std::size_t faces = all.empty() ? 0 : std::size_t(mesh_.n_interior);
  file.write(mesh::Entries::interior_faces, "pressure-preconditioner-faces", all.subspan(owned, faces));
}

template <int D>
void PressureEquation<D>::load(io::CheckpointReader& file) {
  if (fixed_) return;
  // A different number of ranks requires another preconditioner, so it is rebuilt.
  linalg::PreconditionerMemory memory;
  std::vector<double> saved;
  if (file.on_same_ranks()) {
    io::Archive(file).common("pressure-preconditioner-memory", memory.is_due, memory.most_iterations);
    saved = file.read_or_none(mesh::Entries::owned_cells, "pressure-preconditioner", 1);
    const std::vector<double> faces =
        file.read_or_none(mesh::Entries::interior_faces, "pressure-preconditioner-faces", 1);
    saved.insert(saved.end(), faces.begin(), faces.end());
    const std::size_t coefficients = std::size_t(mesh_.cells.n_owned()) + std::size_t(mesh_.n_interior);
    if (!memory.is_due && saved.size() != coefficients)
      throw Error("The checkpoint's preconditioner of the pressure is damaged. Use an earlier one.");
  }
  const bool is_here = solver_->solver().memory() == memory && *now_.made_from == saved;
  if (parallel::any(mesh_.comm, !is_here)) {
    if (!memory.is_due) fill(saved), values_ = saved;
    solver_->solver().restore(memory);
    now_ = {memory, std::make_shared<const std::vector<double>>(std::move(saved))};
  }
  accept();
}

template <int D>
void PressureEquation<D>::set(const Placement<D>& at, bool regular, const Diagonal& added) {
  regular_ = regular;
  if (!solver_) make_solver();
  values_ = diagonal(at, added);
  for (Index f = 0; f < mesh_.n_interior; ++f) values_.push_back(-at.conductance[f]);
  fill(values_);
  if (fixed_) std::vector<double>().swap(values_), solver_->solver().refresh();
}

// The pressure of a closed domain is solvable up to a constant only if the fluxes sum to zero.
template <int D>
void PressureEquation<D>::remove_mean(std::vector<double>& b) const {
  const double sum = parallel::sum(mesh_.comm, as_vector(std::span<const double>(b)).sum());
  as_vector(std::span(b)).array() -= sum / static_cast<double>(mesh_.cells.n_global());
}

/// Rejects a tolerance that is not finite, from fluxes whose squares overflow.
template <int D>
linalg::SolveStatistics PressureEquation<D>::solve_or_report(const Placement<D>& at,
                                                             std::span<const double> b, std::span<double> p,
                                                             double relative, double absolute) {
  const auto where = [&] {
    return largest_entry(find_largest(mesh_, at, [&](Index c) { return std::abs(b[c]); }));
  };
  if (!std::isfinite(absolute))
    throw SolveFailure("The fluxes of the pressure equation are out of range. {}", where());
  try {
    return solver_->solver().solve(b, p, relative, absolute);
  } catch (const SolveFailure& failure) {  // on all ranks alike
    throw SolveFailure("{} {}", failure.what(), where());
  }
}

template <int D>
double PressureEquation<D>::size_without_level(const Placement<D>& at, std::span<const double> b,
                                               std::span<const double> given, double tolerance) const {
  std::vector<double> coefficients(
      mesh_.cells.n_local());  // of given pressures, summed over the faces of a cell
  double sums[2] = {};
  for (const Index face : boundary_.rows().of_pressure) {
    const Index f = mesh_.n_interior + face;
    const double row = boundary_.rows().pressure[face] * at.conductance[f];
    coefficients[mesh_.owner[f]] += row;
    sums[0] += row * given[face], sums[1] += row;
  }
  MPI_Allreduce(MPI_IN_PLACE, sums, 2, MPI_DOUBLE, MPI_SUM, mesh_.comm);
  const double mean = sums[1] > 0 ? sums[0] / sums[1] : 0;
  double squares[2] = {};
  for (std::size_t c = 0; c < b.size(); ++c) {
    const double left = b[c] - mean * coefficients[c];
    squares[0] += left * left, squares[1] += b[c] * b[c];
  }
  MPI_Allreduce(MPI_IN_PLACE, squares, 2, MPI_DOUBLE, MPI_SUM, mesh_.comm);
  return std::max(std::sqrt(squares[0]), side_rounding / tolerance * std::sqrt(squares[1]));
}

template <int D>
linalg::SolveStatistics PressureEquation<D>::solve(const Placement<D>& at, std::vector<double>& b,
                                                   std::vector<double>& p, double relative, double absolute,
                                                   double answer, double size) {
  const Index owned = mesh_.cells.n_owned();
  if (singular()) {
    remove_mean(b);
    // Doubling the first diagonal entry makes the matrix regular for direct solvers and p = 0 there, the same
    // solution up to a constant. CG uses the singular matrix, because b sums to zero. The tiny lowest
    // eigenvalue of a regularized one slows float multigrid (cavity 32^3: 214 instead of 151 iterations).
    double pin = owned > 0 ? p[0] : 0;
    MPI_Bcast(&pin, 1, MPI_DOUBLE, 0, mesh_.comm);
    as_vector(std::span(p).first(owned)).array() -= pin;
  }
  if (answer > 0) {
    const double enough = relative * (size < 0 ? solver_->solver().norm(b) : size);
    const double left = answer * solver_->solver().true_residual(b, std::span<const double>(p).first(owned));
    absolute = std::max({absolute, least_answer * enough, std::min(enough, left)});
    relative = 0;
  } else if (size >= 0) {
    absolute = std::max(absolute, relative * size);
    relative = 0;
  }
  const int made = solver_->solver().preconditioners_built();
  const linalg::SolveStatistics statistics =
      solve_or_report(at, b, std::span<double>(p).first(owned), relative, absolute);
  if (!fixed_) {
    now_.memory = solver_->solver().memory();
    if (solver_->solver().preconditioners_built() != made)
      now_.made_from = std::make_shared<const std::vector<double>>(values_);
  }
  if (singular()) {
    double sums[2] = {0, 0};
    const auto add = [&](double weight, Index c) {
      sums[0] += weight * p[c];
      sums[1] += weight;
    };
    if (boundary_.has_convective_outlet()) {
      for (Index f = mesh_.n_interior; f < mesh_.n_flux_faces(); ++f)
        if (boundary_.is_convective(f - mesh_.n_interior)) add(at.area[f].norm(), mesh_.owner[f]);
    } else {
      const auto volume = as_vector(std::span<const double>(at.volume).first(owned));
      sums[0] = volume.dot(as_vector(std::span(p).first(owned)));
      sums[1] = volume.sum();
    }
    MPI_Allreduce(MPI_IN_PLACE, sums, 2, MPI_DOUBLE, MPI_SUM, mesh_.comm);
    as_vector(std::span(p).first(owned)).array() -= sums[0] / sums[1];
  }
  mesh_.cells.update_ghosts(p);
  return statistics;
}

template class PressureEquation<2>;
template class PressureEquation<3>;

}  // namespace couplet::fluid
