// SPDX-License-Identifier: Apache-2.0
#include "fluid_solver/pressure/pressure.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "common/base/error.hpp"
#include "common/parallel/collective.hpp"
#include "fluid_solver/pressure/largest_entry.hpp"

namespace couplet::fluid {

// Up to here kept Cholesky factors beat multigrid in 2-D: thin cells cost them no iterations.
constexpr GlobalIndex largest_direct = 120000;

template <int D>
PressureEquation<D>::PressureEquation(const mesh::Mesh& mesh, const Boundary<D>& boundary, bool fixed,
                                      const Couplings* couplings)
    : mesh_(mesh),
      boundary_(boundary),
      couplings_(couplings),
      fixed_(fixed),
      direct_(D == 2 && mesh.cells.n_global() <= largest_direct) {}

// Triplets: the diagonal of each owned cell first, then the neighbours face by face, then what is coupled beside.
template <int D>
void PressureEquation<D>::make_pattern() {
  const Index owned = mesh_.cells.n_owned();
  std::vector<GlobalIndex> row(owned), column;
  std::iota(row.begin(), row.end(), mesh_.cells.first());
  column = row;
  const auto add = [&](Index from, Index to) {
    if (from >= owned) return;
    row.push_back(mesh_.cells.global(from));
    column.push_back(mesh_.cells.global(to));
  };
  for (Index f = 0; f < mesh_.n_interior; ++f) {
    add(mesh_.owner[f], mesh_.neighbour[f]);
    add(mesh_.neighbour[f], mesh_.owner[f]);
  }
  if (couplings_) {
    for (const Index cell : couplings_->row) row.push_back(mesh_.cells.global(cell));
    column.insert(column.end(), couplings_->column.begin(), couplings_->column.end());
  }
  values_.resize(row.size());
  matrix_ = std::make_unique<linalg::SparseMatrix>(mesh_.comm, owned, std::move(row), std::move(column));
}

template <int D>
std::vector<double> PressureEquation<D>::diagonal(const Placement<D>& at, std::span<const double> admittance,
                                                  std::span<const double> storage) const {
  const Index owned = mesh_.cells.n_owned();
  std::vector<double> sum(owned, 0.0);
  for (Index f = 0; f < mesh_.n_interior; ++f)
    for (const Index cell : {mesh_.owner[f], mesh_.neighbour[f]})
      if (cell < owned) sum[cell] += at.conductance[f];
  for (const Index b : boundary_.rows().of_pressure)
    sum[mesh_.owner[mesh_.n_interior + b]] += at.conductance[mesh_.n_interior + b];
  for (std::size_t b = 0; b < admittance.size(); ++b)
    sum[mesh_.owner[mesh_.n_interior + static_cast<Index>(b)]] += admittance[b];
  for (std::size_t c = 0; c < storage.size(); ++c) sum[c] += storage[c];
  for (double& value : sum)
    if (value == 0) value = 1;  // inside a body: p = 0 there
  if (singular() && owned > 0 && mesh_.cells.first() == 0) sum[0] *= 2;
  return sum;
}

// Entry by entry, so that nothing but the matrix itself takes memory.
template <int D>
void PressureEquation<D>::make_fixed(const Placement<D>& at) {
  const Index owned = mesh_.cells.n_owned();
  std::vector<int> own(owned, 1), other(owned, 0);
  const auto count = [&](Index from, Index to) {
    if (from < owned) ++(to < owned ? own : other)[from];
  };
  for (Index f = 0; f < mesh_.n_interior; ++f) {
    count(mesh_.owner[f], mesh_.neighbour[f]);
    count(mesh_.neighbour[f], mesh_.owner[f]);
  }
  matrix_ = std::make_unique<linalg::SparseMatrix>(mesh_.comm, own, other);
  const auto set = [&](Index from, Index to, double value) {
    if (from < owned) matrix_->set(mesh_.cells.global(from), mesh_.cells.global(to), value);
  };
  const std::vector<double> middle = diagonal(at, {}, {});
  for (Index c = 0; c < owned; ++c) set(c, c, middle[c]);
  for (Index f = 0; f < mesh_.n_interior; ++f) {
    set(mesh_.owner[f], mesh_.neighbour[f], -at.conductance[f]);
    set(mesh_.neighbour[f], mesh_.owner[f], -at.conductance[f]);
  }
  matrix_->complete();
}

/// Of the matrix as it stands: its diagonal per owned cell, then one entry a face, which stands in it twice, then the
/// couplings.
template <int D>
std::vector<double> PressureEquation<D>::coefficients() const {
  const Index owned = mesh_.cells.n_owned();
  std::vector<double> all(values_.begin(), values_.begin() + owned);
  all.resize(std::size_t(owned) + mesh_.n_interior);
  std::size_t next = owned;
  for (Index f = 0; f < mesh_.n_interior; ++f)
    for (const Index cell : {mesh_.owner[f], mesh_.neighbour[f]})
      if (cell < owned) all[owned + f] = values_[next++];
  all.insert(all.end(), values_.begin() + std::ptrdiff_t(next), values_.end());
  return all;
}

/// The other way round.
template <int D>
void PressureEquation<D>::fill(std::span<const double> coefficients) {
  const Index owned = mesh_.cells.n_owned();
  std::copy_n(coefficients.begin(), owned, values_.begin());
  std::size_t next = owned;
  for (Index f = 0; f < mesh_.n_interior; ++f)
    for (const Index cell : {mesh_.owner[f], mesh_.neighbour[f]})
      if (cell < owned) values_[next++] = coefficients[owned + f];
  std::copy(coefficients.begin() + owned + mesh_.n_interior, coefficients.end(),
            values_.begin() + std::ptrdiff_t(next));
  matrix_->fill(values_);
}

template <int D>
void PressureEquation<D>::save(io::CheckpointWriter& file) const {
  if (fixed_) return;
  file.write_scalar("pressure-preconditioner-due", accepted_.memory.is_due);
  file.write_scalar("pressure-preconditioner-single", accepted_.memory.is_single);
  file.write_scalar("pressure-preconditioner-iterations", accepted_.memory.most_iterations);
  const std::span<const double> all = *accepted_.made_from;  // nothing, or the diagonal, then the faces
  const std::size_t owned = all.empty() ? 0 : std::size_t(mesh_.cells.n_owned());
  file.write(mesh::Entries::owned_cells, "pressure-preconditioner", all.first(owned));
  const std::size_t faces = all.empty() ? 0 : std::size_t(mesh_.n_interior);
  file.write(mesh::Entries::interior_faces, "pressure-preconditioner-faces", all.subspan(owned, faces));
  if (couplings_) file.write("pressure-preconditioner-couplings", all.subspan(owned + faces));
}

template <int D>
void PressureEquation<D>::load(io::CheckpointReader& file) {
  if (fixed_) return;
  // Other ranks have another kind of preconditioner, or another one of the same kind: it is made anew.
  linalg::PreconditionerMemory memory{true, solver_->memory().is_single, 0};
  std::vector<double> saved;
  if (file.on_same_ranks()) {
    memory.is_due = file.read_scalar("pressure-preconditioner-due") != 0;
    memory.is_single = file.read_scalar("pressure-preconditioner-single") != 0;
    memory.most_iterations = static_cast<int>(file.read_count("pressure-preconditioner-iterations", 1000000));
    saved = file.read_or_none(mesh::Entries::owned_cells, "pressure-preconditioner", 1);
    const std::vector<double> faces =
        file.read_or_none(mesh::Entries::interior_faces, "pressure-preconditioner-faces", 1);
    saved.insert(saved.end(), faces.begin(), faces.end());
    if (couplings_) {
      const std::vector<double> beside = file.read("pressure-preconditioner-couplings");
      saved.insert(saved.end(), beside.begin(), beside.end());
    }
    const std::size_t coefficients = std::size_t(mesh_.cells.n_owned()) + std::size_t(mesh_.n_interior) +
                                     (couplings_ ? couplings_->row.size() : 0);
    if (!memory.is_due && saved.size() != coefficients)
      throw Error("The checkpoint's preconditioner of the pressure is damaged. Use an earlier one.");
  }
  const bool is_here = solver_->memory() == memory && *now_.made_from == saved;
  if (parallel::any(mesh_.comm, !is_here)) {
    if (!memory.is_due) fill(saved);
    solver_->restore(memory);
    now_ = {memory, std::make_shared<const std::vector<double>>(std::move(saved))};
  }
  accept();
}

template <int D>
void PressureEquation<D>::set(const Placement<D>& at, bool regular, std::span<const double> admittance,
                              std::span<const double> storage) {
  regular_ = regular;
  if (fixed_) {
    solver_.reset();
    make_fixed(at);
  } else {
    if (!matrix_) make_pattern();
    const std::vector<double> middle = diagonal(at, admittance, storage);
    std::size_t next = std::copy(middle.begin(), middle.end(), values_.begin()) - values_.begin();
    for (Index f = 0; f < mesh_.n_interior; ++f)
      for (const Index cell : {mesh_.owner[f], mesh_.neighbour[f]})
        if (cell < mesh_.cells.n_owned()) values_[next++] = -at.conductance[f];
    if (couplings_) std::ranges::copy(couplings_->value, values_.begin() + std::ptrdiff_t(next));
    matrix_->fill(values_);
  }
  if (solver_) return solver_->matrix_changed();
  linalg::LinearOptions options;
  options.method = !direct_ ? linalg::LinearMethod::cg_multigrid
                   : fixed_ ? linalg::LinearMethod::cg_direct
                            : linalg::LinearMethod::cg_single;
  solver_ = std::make_unique<linalg::LinearSolver>("pressure", *matrix_, options);
}

// A closed domain has a pressure up to a constant only if the fluxes add up to nothing.
template <int D>
void PressureEquation<D>::remove_mean(std::vector<double>& b) const {
  const double mean = parallel::sum(mesh_.comm, std::accumulate(b.begin(), b.end(), 0.0)) /
                      static_cast<double>(mesh_.cells.n_global());
  for (double& value : b) value -= mean;
}

/// A tolerance that is not finite would let anything pass: fluxes whose squares overflow make one.
template <int D>
linalg::SolveStatistics PressureEquation<D>::solve_or_tell(const Placement<D>& at, std::span<const double> b,
                                                           std::span<double> p, double relative,
                                                           double absolute) {
  const auto where = [&] { return largest_entry<D>(mesh_, at, [&](Index c) { return b[c]; }); };
  if (!std::isfinite(absolute))
    throw SolveFailure("The fluxes of the pressure equation are out of range. {}", where());
  try {
    return solver_->solve(b, p, relative, absolute);
  } catch (const SolveFailure& failure) {  // on all ranks alike
    throw SolveFailure("{} {}", failure.what(), where());
  }
}

template <int D>
linalg::SolveStatistics PressureEquation<D>::solve(const Placement<D>& at, std::vector<double>& b,
                                                   std::vector<double>& p, double relative, double absolute,
                                                   double answer, double size) {
  const Index owned = mesh_.cells.n_owned();
  if (singular()) {
    remove_mean(b);
    // Twice the first diagonal entry makes the matrix regular and p = 0 there, the same solution but for a
    // constant.
    double pin = owned > 0 ? p[0] : 0;
    MPI_Bcast(&pin, 1, MPI_DOUBLE, 0, mesh_.comm);
    for (Index c = 0; c < owned; ++c) p[c] -= pin;
  }
  if (answer > 0) {
    const double enough = relative * (size < 0 ? solver_->norm(b) : size);
    const double left = answer * solver_->true_residual(b, std::span<const double>(p).first(owned));
    absolute = std::max({absolute, least_answer * enough, std::min(enough, left)});
    relative = 0;
  } else if (size >= 0) {
    absolute = std::max(absolute, relative * size);
    relative = 0;
  }
  const int made = solver_->preconditioners_built();
  const linalg::SolveStatistics statistics =
      solve_or_tell(at, b, std::span<double>(p).first(owned), relative, absolute);
  if (!fixed_) {
    now_.memory = solver_->memory();
    if (solver_->preconditioners_built() != made)
      now_.made_from = std::make_shared<const std::vector<double>>(coefficients());
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
      for (Index c = 0; c < owned; ++c) add(at.volume[c], c);
    }
    MPI_Allreduce(MPI_IN_PLACE, sums, 2, MPI_DOUBLE, MPI_SUM, mesh_.comm);
    for (Index c = 0; c < owned; ++c) p[c] -= sums[0] / sums[1];
  }
  mesh_.cells.update_ghosts(p);
  return statistics;
}

template class PressureEquation<2>;
template class PressureEquation<3>;

}  // namespace couplet::fluid
