// SPDX-License-Identifier: Apache-2.0
#include "fluid_solver/pressure.hpp"

#include <algorithm>
#include <numeric>

#include "common/parallel/collective.hpp"

namespace couplet::fluid {

// Up to here kept Cholesky factors beat multigrid in 2-D: thin cells cost them no iterations.
constexpr GlobalIndex largest_direct = 120000;

template <int D>
PressureEquation<D>::PressureEquation(const Mesh& mesh, const Boundary<D>& boundary, bool fixed)
    : mesh_(mesh),
      boundary_(boundary),
      fixed_(fixed),
      direct_(D == 2 && mesh.cells.n_global() <= largest_direct) {
  make_matrix();  // now, while there is memory
}

// Triplets: the diagonal of each owned cell first, then the neighbours face by face.
template <int D>
void PressureEquation<D>::make_matrix() {
  const Index owned = mesh_.cells.n_owned();
  std::vector<GlobalIndex> row(owned), column;
  row.reserve(owned + 2 * std::size_t(mesh_.n_interior));
  std::iota(row.begin(), row.end(), mesh_.cells.first());
  column.reserve(row.capacity());
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
  solver_.reset();
  matrix_ = std::make_unique<SparseMatrix>(mesh_.comm, owned, std::move(row), std::move(column));
}

template <int D>
void PressureEquation<D>::set(const Placement<D>& at) {
  if (fixed_ && solver_) make_matrix();
  const Index owned = mesh_.cells.n_owned();
  std::vector<double> values(owned + 2 * std::size_t(mesh_.n_interior));
  std::size_t next = owned;
  for (Index f = 0; f < mesh_.n_interior; ++f) {
    for (const Index cell : {mesh_.owner[f], mesh_.neighbour[f]}) {
      if (cell >= owned) continue;
      values[cell] += at.conductance[f];
      values[next++] = -at.conductance[f];
    }
  }
  for (Index f = mesh_.n_interior; f < mesh_.n_flux_faces(); ++f)
    if (boundary_.kind()[f - mesh_.n_interior] == FaceKind::pressure)
      values[mesh_.owner[f]] += at.conductance[f];
  for (Index c = 0; c < owned; ++c)
    if (values[c] == 0) values[c] = 1;  // inside a body: p = 0 there
  if (boundary_.closed() && owned > 0 && mesh_.cells.first() == 0) values[0] *= 2;
  values.resize(next);  // faces to ghost cells have one row here
  matrix_->fill(values);
  values = {};
  if (fixed_) matrix_->freeze();
  if (solver_) {
    solver_->matrix_changed();
  } else {
    LinearOptions options;
    options.method = direct_ ? LinearMethod::cg_direct : LinearMethod::cg_multigrid;
    solver_ = std::make_unique<LinearSolver>("pressure", *matrix_, options);
  }
}

// A closed domain has a pressure up to a constant only if the fluxes add up to nothing.
template <int D>
void PressureEquation<D>::remove_mean(std::vector<double>& b) const {
  const double mean =
      sum(mesh_.comm, std::accumulate(b.begin(), b.end(), 0.0)) / static_cast<double>(mesh_.cells.n_global());
  for (double& value : b) value -= mean;
}

template <int D>
SolveStatistics PressureEquation<D>::solve(const Placement<D>& at, std::vector<double>& b,
                                           std::vector<double>& p, double relative, double absolute) {
  const Index owned = mesh_.cells.n_owned();
  if (boundary_.closed()) {
    remove_mean(b);
    // Twice the first diagonal entry makes the matrix regular and p = 0 there, the same solution but for a
    // constant.
    double pin = owned > 0 ? p[0] : 0;
    MPI_Bcast(&pin, 1, MPI_DOUBLE, 0, mesh_.comm);
    for (Index c = 0; c < owned; ++c) p[c] -= pin;
  }
  const SolveStatistics statistics = solver_->solve(b, std::span<double>(p).first(owned), relative, absolute);
  if (boundary_.closed()) {
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
