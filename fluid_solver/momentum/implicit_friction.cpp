// SPDX-License-Identifier: Apache-2.0
#include "fluid_solver/momentum/implicit_friction.hpp"

#include <algorithm>
#include <cmath>

#include "common/base/error.hpp"

namespace couplet::fluid {
namespace {

constexpr int most_passes = 60, passes_alone = 4;
constexpr linalg::Acceleration pass_acceleration{linalg::Acceleration::Type::anderson, 1, 6};
// nu_t (grad u + grad u^T) has at most twice the rate of nu_t grad u.
constexpr double stress_of_eddies = 2;

}  // namespace

/// Residuals accumulate over the steps, so the tolerance is much smaller than the change of u per step.
template <int D>
double ImplicitFriction<D>::tolerance() const {
  return std::min(1e-7, 0.1 * scene_.parameters.pressure_tolerance);
}

/// First guess u^n + r (u^n - u^{n-1}) and one Jacobi sweep, without a face loop: its viscous rate is
/// extrapolated too.
template <int D>
void ImplicitFriction<D>::guess(const State<D>& from, const Rates<D>& rates, double a, const Vectors<D>& side,
                                Vectors<D>& u) const {
  if (step_.by.dt_old == 0) {
    u = from.u;
    return;
  }
  const double ratio = step_.ratio();
  const std::vector<double>& inverse = solver_.inverse_diagonal();
  for (Index c = 0; c < mesh_.cells.n_owned(); ++c) {
    const Vec<D> ahead = from.u[c] + ratio * (from.u[c] - from.u_old[c]);
    const Vec<D> rate = rates.viscous[c] + ratio * (rates.viscous[c] - from.rates_old.viscous[c]);
    u[c] = ahead + inverse[c] * (side[c] + step_.dt * a * rate - step_.to->volume[c] * ahead);
  }
  mesh_.cells.update_ghosts(flat<D>(u), D);
}

template <int D>
void ImplicitFriction<D>::solve(const State<D>& from, const Rates<D>& rates, const Vectors<D>& w, double a,
                                Vectors<D>& side, Vectors<D>& u) {
  const EddyShare eddies =
      from.eddy.empty() ? EddyShare{} : EddyShare{&eddy_, stress_of_eddies * a * step_.dt};
  if (eddies.eddy) add_eddies(from, side);
  solver_.prepare(step_.to, a * scene_.fluid.nu * step_.dt, eddies);
  guess(from, rates, a, side, u);
  if (eddies.eddy) damp_eddies(from, eddies, side);
  if (scene_.oblique)
    solve_in_passes(w, a, side, u);
  else
    iterations_ += solver_.solve(w, tolerance(), side, u);
}

/// Adds the stress of u~ = (1 + r/2) u^n - r/2 u^{n-1} with its own nu_t on the mesh of level n. The nu_t
/// here and in damp_eddies() must be the same for all three levels. With Adams-Bashforth, a nu_t that
/// decreases tenfold per step, as in an opening gap, would leave an undamped old rate.
template <int D>
void ImplicitFriction<D>::add_eddies(const State<D>& from, Vectors<D>& side) {
  const double ratio = step_.ratio(), e0 = 1 + ratio / 2, e1 = -ratio / 2;
  between_ = from.u;
  between_boundary_ = from.u_boundary;
  if (ratio > 0) {
    for (std::size_t c = 0; c < between_.size(); ++c) between_[c] = e0 * from.u[c] + e1 * from.u_old[c];
    for (std::size_t b = 0; b < between_boundary_.size(); ++b)
      between_boundary_[b] = e0 * from.u_boundary[b] + e1 * from.u_boundary_old[b];
  }
  eddy_rate_.assign(between_.size(), Vec<D>::Zero());
  rate_operator_.add_eddies(*scene_.parameters.turbulence, *from.placement, between_, between_boundary_,
                            eddy_, eddy_rate_);
  scene_.obstacles->clear(eddy_rate_);
  for (Index c = 0; c < mesh_.cells.n_owned(); ++c) side[c] += step_.dt * eddy_rate_[c];
}

/// Adds theta dt nu_t g times the second time difference of u, whose part at n+1 is in the matrix. With a of
/// modified Crank-Nicolson an extrapolated rate becomes that scheme, and nu_t does not limit the step. In
/// thin cells, a few times the molecular viscosity would require a thousandth of the convective step.
template <int D>
void ImplicitFriction<D>::damp_eddies(const State<D>& from, const EddyShare& eddies, Vectors<D>& side) const {
  const double ratio = step_.ratio();
  const auto ahead = [&](Index c) {
    return ratio > 0 ? Vec<D>((1 + ratio) * from.u[c] - ratio * from.u_old[c]) : from.u[c];
  };
  for (Index f = 0; f < mesh_.n_interior; ++f) {
    const Index p = mesh_.owner[f], n = mesh_.neighbour[f];
    const Vec<D> part = eddies.at(p, n) * step_.to->conductance[f] * (ahead(n) - ahead(p));
    side[p] -= part;
    side[n] += part;
  }
}

/// The non-orthogonal part is implicit by deferred correction. An explicit one is unstable if its share of
/// the operator exceeds 1/8 (AB2 against 9/16, 3/8, 1/16), as on a mesh sheared by 14 degrees. The passes
/// converge by that share.
template <int D>
void ImplicitFriction<D>::solve_in_passes(const Vectors<D>& w, double a, const Vectors<D>& side,
                                          Vectors<D>& u) {
  const double enough = std::clamp(10 * scene_.parameters.pressure_tolerance, 1e-11, 1e-4);
  for (int pass = 1;; ++pass) {
    scene_.boundary.close(mesh_, *step_.to, u, w, u_boundary_);
    oblique_rate_.assign(u.size(), Vec<D>::Zero());
    rate_operator_.add_oblique(*step_.to, u, u_boundary_, oblique_rate_);
    right_side_ = side;
    for (Index c = 0; c < mesh_.cells.n_owned(); ++c) right_side_[c] += step_.dt * a * oblique_rate_[c];
    before_ = u;
    iterations_ += solver_.solve(w, tolerance(), right_side_, u);
    double sums[2] = {0, 0};
    for (Index c = 0; c < mesh_.cells.n_owned(); ++c) {
      sums[0] += (u[c] - before_[c]).squaredNorm();
      sums[1] += u[c].squaredNorm();
    }
    MPI_Allreduce(MPI_IN_PLACE, sums, 2, MPI_DOUBLE, MPI_SUM, mesh_.comm);
    if (sums[0] <= enough * enough * sums[1]) return;
    if (pass == most_passes)
      throw SolveFailure(
          "The non-orthogonal correction of the viscous term did not converge in {} passes (change {:.2e}). "
          "The mesh is too skewed for an implicit viscous term: use 'viscous: explicit'.",
          most_passes, std::sqrt(sums[0] / sums[1]));
    if (pass >= passes_alone) accelerate(pass == passes_alone, u);
  }
}

/// Computes the guess of the next pass from u and before_ by Anderson acceleration. Collective.
template <int D>
void ImplicitFriction<D>::accelerate(bool start, Vectors<D>& u) {
  const std::size_t owned = static_cast<std::size_t>(mesh_.cells.n_owned()) * D;
  if (!accelerator_)
    accelerator_ = std::make_unique<linalg::Accelerator>(mesh_.comm, owned, pass_acceleration);
  if (start) accelerator_->restart();
  for (Index c = 0; c < mesh_.cells.n_owned(); ++c) u[c] -= before_[c];
  accelerator_->advance(flat<D>(before_).first(owned), flat<D>(u).first(owned));
  u.swap(before_);
  mesh_.cells.update_ghosts(flat<D>(u), D);
}

template class ImplicitFriction<2>;
template class ImplicitFriction<3>;

}  // namespace couplet::fluid
