// SPDX-License-Identifier: Apache-2.0
#include "fluid_solver/pressure/viscous_solver.hpp"

#include <array>
#include <cmath>

#include "common/base/error.hpp"
#include "fluid_solver/pressure/largest_entry.hpp"

namespace couplet::fluid {
namespace {

constexpr int most_iterations = 2000;

template <std::size_t N>
void sum_all(MPI_Comm comm, std::array<double, N>& values) {
  MPI_Allreduce(MPI_IN_PLACE, values.data(), static_cast<int>(N), MPI_DOUBLE, MPI_SUM, comm);
}

}  // namespace

template <int D>
void ViscousSolver<D>::multiply(Vectors<D>& x, Vectors<D>& y) const {
  const Placement<D>& at = *at_;
  const double beta = beta_;
  mesh_.cells.update_ghosts(flat<D>(x), D);
  for (Index c = 0; c < mesh_.cells.n_local(); ++c) y[c] = at.volume[c] * x[c];
  for (Index f = 0; f < mesh_.n_interior; ++f) {
    const Index p = mesh_.owner[f], n = mesh_.neighbour[f];
    const Vec<D> part = beta * at.conductance[f] * (x[p] - x[n]);
    y[p] += part;
    y[n] -= part;
  }
  for (const BoundaryRow& row : rows_) y[row.cell] += row.times(x[row.cell]);
}

template <int D>
void ViscousSolver<D>::prepare(const Placement<D>& at, double beta) {
  at_ = &at;
  beta_ = beta;
  inverse_diagonal_.assign(at.volume.begin(), at.volume.end());
  for (Index f = 0; f < mesh_.n_interior; ++f) {
    const double a = beta * at.conductance[f];
    inverse_diagonal_[mesh_.owner[f]] += a;
    inverse_diagonal_[mesh_.neighbour[f]] += a;
  }
  rows_.clear();
  const FaceRows& given = boundary_.rows();
  for (Index f = mesh_.n_interior; f < mesh_.n_flux_faces(); ++f) {
    const Index b = f - mesh_.n_interior;
    const double a = beta * at.conductance[f], t = given.friction(at, b, f);
    inverse_diagonal_[mesh_.owner[f]] += a;
    rows_.push_back({mesh_.owner[f], a * t, a * (1 - given.pressure[b] - t), at.area[f].normalized()});
  }
  for (Index c = 0; c < mesh_.cells.n_owned(); ++c) inverse_diagonal_[c] = 1 / inverse_diagonal_[c];
}

template <int D>
void ViscousSolver<D>::add_boundary(const Vectors<D>& w, Vectors<D>& b) const {
  for (std::size_t face = 0; face < rows_.size(); ++face) b[rows_[face].cell] += rows_[face].times(w[face]);
}

template <int D>
int ViscousSolver<D>::solve(const Vectors<D>& w, double tolerance, Vectors<D>& b, Vectors<D>& u) {
  const Index owned = mesh_.cells.n_owned();
  r_.resize(u.size());
  q_.resize(u.size());
  search_.assign(u.size(), Vec<D>::Zero());
  add_boundary(w, b);
  multiply(u, q_);
  std::array<double, 2> sums{};  // b.D^-1 b, r.D^-1 r
  for (Index c = 0; c < owned; ++c) {
    r_[c] = b[c] - q_[c];
    search_[c] = inverse_diagonal_[c] * r_[c];
    sums[0] += inverse_diagonal_[c] * b[c].squaredNorm();
    sums[1] += r_[c].dot(search_[c]);
  }
  sum_all(mesh_.comm, sums);
  const double goal = tolerance * tolerance * sums[0];
  double rz = sums[1];
  int iterations = 0;
  while (rz > goal && iterations < most_iterations) {
    ++iterations;
    multiply(search_, q_);
    std::array<double, 1> curvature{};
    for (Index c = 0; c < owned; ++c) curvature[0] += search_[c].dot(q_[c]);
    sum_all(mesh_.comm, curvature);
    if (!(curvature[0] > 0)) break;
    const double alpha = rz / curvature[0];
    std::array<double, 1> next{};
    for (Index c = 0; c < owned; ++c) {
      u[c] += alpha * search_[c];
      r_[c] -= alpha * q_[c];
      next[0] += inverse_diagonal_[c] * r_[c].squaredNorm();
    }
    sum_all(mesh_.comm, next);
    const double gamma = next[0] / rz;
    rz = next[0];
    for (Index c = 0; c < owned; ++c) search_[c] = inverse_diagonal_[c] * r_[c] + gamma * search_[c];
  }
  // The round-off of b itself is all that can be asked for: a little above it counts as solved.
  if (!(rz <= std::max(goal, 1e-26 * sums[0])))
    throw SolveFailure(
        "The implicit viscous solve did not converge: residual {:.3e} of {:.3e} after {} iterations. {}",
        std::sqrt(rz), std::sqrt(sums[0]), iterations,
        largest_entry<D>(mesh_, *at_, [&](Index c) { return b[c].norm(); }));
  mesh_.cells.update_ghosts(flat<D>(u), D);
  return iterations;
}

template class ViscousSolver<2>;
template class ViscousSolver<3>;

}  // namespace couplet::fluid
