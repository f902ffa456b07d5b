// SPDX-License-Identifier: Apache-2.0
#include "fluid_solver/step/stages.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "common/base/processor_clones.hpp"
#include "common/parallel/collective.hpp"
#include "fluid_solver/step/step_size.hpp"

namespace couplet::fluid {
namespace {

// Tolerated share of the boundary fluxes, because their rates are means of two levels.
constexpr double boundary_share = 0.25;
// Relative error of the pressure level allowed to the solver, which moves the fluid.
constexpr double level_share = 1e-4;
// Excess over the kinetic energy that is reported, and that counts as divergence.
constexpr double reported_excess = 0.1, largest_excess = 0.5;
// Decay of the reference energy per sub-step. A reversing flow is at rest briefly, so its current energy is
// no measure.
constexpr double remembered = 0.85;

/// sum V |u|^2, in four partial sums, so that additions do not wait for each other.
template <int D>
COUPLET_PROCESSOR_CLONES double sum_squares(std::span<const double> volume, const Vec<D>* u) {
  std::array<double, 4> sum{};
  std::size_t c = 0;
  for (; c + 4 <= volume.size(); c += 4)
    for (std::size_t k = 0; k < 4; ++k) sum[k] += volume[c + k] * u[c + k].squaredNorm();
  for (; c < volume.size(); ++c) sum[0] += volume[c] * u[c].squaredNorm();
  return (sum[0] + sum[1]) + (sum[2] + sum[3]);
}

}  // namespace

template <int D>
double EnergyCheck<D>::kinetic(const Placement<D>& at, const Vectors<D>& u) const {
  return 0.5 * rho_ * sum_squares<D>(std::span(at.volume).first(mesh_.cells.n_owned()), u.data());
}

template <int D>
double EnergyCheck<D>::elastic(const Placement<D>& at, const std::array<const PressureLevel<D>*, 3>& pressure,
                               double level) const {
  if (bulk_ == 0 || !pressure[0]) return 0;
  double sum = 0;
  if (const std::vector<double>& end = pressure[0]->end; !end.empty()) {
    for (Index c = 0; c < mesh_.cells.n_owned(); ++c)
      sum += at.volume[c] * (end[c] - level) * (end[c] - level);
    return 0.5 / bulk_ * sum;
  }
  const std::vector<double>& now = pressure[0]->p;
  const std::vector<double>& one = pressure[1] ? pressure[1]->p : now;
  const std::vector<double>& two = pressure[2] ? pressure[2]->p : one;
  for (Index c = 0; c < mesh_.cells.n_owned(); ++c) {
    const double p0 = now[c] - level, p1 = one[c] - level, p2 = two[c] - level;
    sum += at.volume[c] * (3 * p0 * p0 + 2 * p1 * p1 + p2 * p2 - 2 * p0 * p2 - 2 * p1 * p2);
  }
  return 0.25 / bulk_ * sum;
}

/// Reference pressure for the work. Collective.
template <int D>
double EnergyCheck<D>::level_of(const EnergyStep<D>& s) const {
  if (s.from.ledger.energy >= 0) return s.from.ledger.level;
  if (bulk_ == 0) return mean_pressure(s);
  double sums[2] = {};
  const std::vector<double>& p = s.from.pressure[0] ? s.from.pressure[0]->p : s.level.p;
  for (Index c = 0; c < mesh_.cells.n_owned(); ++c)
    sums[0] += s.to.volume[c] * p[c], sums[1] += s.to.volume[c];
  MPI_Allreduce(MPI_IN_PLACE, sums, 2, MPI_DOUBLE, MPI_SUM, mesh_.comm);
  return sums[0] / sums[1];
}

/// Reference pressure for the work without a previous step. Collective.
template <int D>
double EnergyCheck<D>::mean_pressure(const EnergyStep<D>& s) const {
  double sums[2] = {};
  for (std::size_t b = 0; b < s.w.size(); ++b) {
    const std::size_t f = mesh_.n_interior + b;
    const double flux = std::abs(0.5 * (s.from.phi[f] + s.phi[f]));
    sums[0] += s.p[b] * flux;
    sums[1] += flux;
  }
  MPI_Allreduce(MPI_IN_PLACE, sums, 2, MPI_DOUBLE, MPI_SUM, mesh_.comm);
  return sums[1] > 0 ? sums[0] / sums[1] : 0;
}

/// Kinetic energy [J] from pressure solver errors in a fluid at rest: sum of rho V u^2/2 over the cells with
/// u = tolerance p dt/(rho h), the velocity if the boundary pressure p varies by its tolerance between cells.
/// Collective.
template <int D>
double EnergyCheck<D>::energy_at_rest(const EnergyStep<D>& s) const {
  double sums[3] = {0, double(s.p.size()), 0};
  for (const double p : s.p) sums[0] += std::abs(p);
  for (Index c = 0; c < mesh_.cells.n_owned(); ++c) sums[2] += std::pow(s.to.volume[c], 1 - 2. / D);
  MPI_Allreduce(MPI_IN_PLACE, sums, 3, MPI_DOUBLE, MPI_SUM, mesh_.comm);
  const double impulse = pressure_tolerance_ * s.dt * sums[0] / std::max(1., sums[1]);
  return 0.5 * impulse * impulse / rho_ * sums[2];
}

/// sums: work, total flux, p |phi|, |phi|.
template <int D>
void EnergyCheck<D>::add_boundary(const EnergyStep<D>& s, double level, double* sums) const {
  const bool moving = !s.swept.empty();
  const BoundaryRows& rows = boundary_.rows();
  for (std::size_t b = 0; b < s.w.size(); ++b) {
    const Index f = mesh_.n_interior + static_cast<Index>(b), p = mesh_.owner[f];
    const Vec<D> inside = 0.5 * (s.from.u[p] + s.u[p]);
    const double flux = 0.5 * (s.from.phi[f] + s.phi[f]), through = flux - (moving ? s.swept[f] / s.dt : 0);
    const double pressure = -(s.p[b] - level) * flux;
    sums[2] += s.p[b] * std::abs(flux);
    sums[3] += std::abs(flux);
    const double t = rows.friction[b];
    const Vec<D>&before = s.from.u_boundary[b], &after = s.w[b];
    const Vec<D> on_face = 0.5 * (before + after);
    // Contribution of faces of given velocity and of given pressure.
    const double convection = -rho_ * through * (t * (on_face.dot(inside) - 0.5 * inside.squaredNorm())) -
                              rho_ * through * rows.pressure[b] *
                                  ((through < 0 ? rows.inflow[b] : 1.0) - 0.5) * inside.squaredNorm();
    // The larger value of both levels: a stiff layer changes within the step, so its mean is no bound.
    const double friction =
        t * mu_ * s.to.conductance[f] *
        std::max(before.norm() * (before - s.from.u[p]).norm(), after.norm() * (after - s.u[p]).norm());
    sums[0] += s.dt * (pressure + convection + friction);
    sums[1] += s.dt * (std::abs(pressure) + std::abs(convection) + std::abs(friction));
  }
}

/// Adds what the viscous force of a law may do beyond the bound of the constant viscosity. sums: as in add_boundary().
template <int D>
void EnergyCheck<D>::add_law(const EnergyStep<D>& s, double* sums) const {
  for (std::size_t b = 0; b < s.w.size(); ++b) {
    const Index f = mesh_.n_interior + static_cast<Index>(b), p = mesh_.owner[f];
    const Vec<D>&before = s.from.u_boundary[b], &after = s.w[b];
    const double bound =
        boundary_.rows().friction[b] * mu_ * s.to.conductance[f] *
        std::max(before.norm() * (before - s.from.u[p]).norm(), after.norm() * (after - s.u[p]).norm());
    const double more =
        s.dt * std::max(0.0, s.friction[b].norm() * std::max(before.norm(), after.norm()) - bound);
    sums[0] += more;
    sums[1] += more;
  }
}

template <int D>
EnergyChange EnergyCheck<D>::evaluate(const EnergyStep<D>& s) const {
  const EnergySums& before = s.from.ledger;
  enum { work, passed, weighted, fluxes, energy, old_energy };
  double sums[6] = {};
  const double level = level_of(s);
  add_boundary(s, level, sums);
  if (!s.from.excess.empty()) add_law(s, sums);
  const auto& past = s.from.pressure;
  sums[energy] = kinetic(s.to, s.u) + elastic(s.to, {&s.level, past[0].get(), past[1].get()}, level);
  if (before.energy < 0)
    sums[old_energy] = kinetic(*s.from.placement, s.from.u) +
                       elastic(*s.from.placement, {past[0].get(), past[1].get(), past[2].get()}, level);
  if (!s.force.empty())
    for (Index c = 0; c < mesh_.cells.n_owned(); ++c) {
      const double done = 0.5 * s.dt * rho_ * s.to.volume[c] * s.force[c].dot(s.from.u[c] + s.u[c]);
      sums[work] += done;
      sums[passed] += std::abs(done);
    }
  MPI_Allreduce(MPI_IN_PLACE, sums, 6, MPI_DOUBLE, MPI_SUM, mesh_.comm);
  EnergyChange j;
  j.gain = sums[energy] - (before.energy < 0 ? sums[old_energy] : before.energy);
  j.work = sums[work];
  j.ledger.work = before.work + sums[work];
  j.ledger.energy = sums[energy];
  j.ledger.largest = std::max({before.largest, sums[energy], before.energy < 0 ? sums[old_energy] : 0});
  j.ledger.level = bulk_ > 0 ? level : sums[fluxes] > 0 ? sums[weighted] / sums[fluxes] : 0;
  const double unsure =
      boundary_share * sums[passed] + level_share * std::abs(j.ledger.level) * sums[fluxes] * s.dt;
  j.ledger.reference = std::max(sums[energy], remembered * before.reference);
  j.ledger.excess = std::max(0.0, before.excess + j.gain - std::max(0.0, j.work) - unsure);
  // The same on all ranks, and rare. What moves in a fluid at rest is no solution.
  if (j.ledger.excess > reported_excess * j.ledger.reference && sums[energy] <= energy_at_rest(s))
    j.ledger.excess = 0;
  j.out_of_bounds =
      j.gain > 0 && j.ledger.excess > largest_excess * j.ledger.reference && j.ledger.is_known();
  return j;
}

template <int D>
std::string likely_cause(const mesh::Mesh& mesh, const Boundary<D>& boundary, const EnergyStep<D>& s,
                         Index cell, double nu, bool implicit) {
  double convection = 0, diffusion = 0, tangent = 0;
  for (Index f = 0; f < mesh.n_flux_faces(); ++f) {
    const bool outside = f >= mesh.n_interior;
    if (mesh.owner[f] != cell && (outside || mesh.neighbour[f] != cell)) continue;
    convection += 0.5 * std::abs(s.from.phi[f] - (s.swept.empty() ? 0 : s.swept[f] / s.dt));
    const double share = outside ? boundary.rows().friction[f - mesh.n_interior] : 1;
    diffusion += 2 * (nu + (s.from.excess.empty() ? 0 : s.from.excess[f])) * s.to.conductance[f] * share;
    tangent = std::max(tangent, s.to.oblique_of(f).norm() / s.to.area[f].norm());
  }
  convection *= s.dt / s.to.volume[cell];
  diffusion *= s.dt / s.to.volume[cell];
  const double limit = explicit_limit(std::atan2(convection, diffusion)),
               size = std::hypot(convection, diffusion);
  const double degrees = std::atan(tangent) * 180 / std::numbers::pi;
  if (!implicit && diffusion > convection && size > limit)
    return fmt::format(
        "The explicit viscous term is stable there up to a step of {:.3g} s, but this step is {:.3g} s: use "
        "'viscous: auto' or remove 'time-step'.",
        s.dt * limit / size, s.dt);
  if (convection > 1)
    return fmt::format(
        "The flow crosses {:.3g} of that cell in one step of {:.3g} s; explicit convection requires less "
        "than 1: remove 'time-step' or reduce it.",
        convection, s.dt);
  if (degrees > 40)
    return fmt::format(
        "A face of that cell is {:.0f} degrees off the line between the cell centers: a smaller step does "
        "not help; use a mesh without such cells.",
        degrees);
  return {};
}

template class EnergyCheck<2>;
template class EnergyCheck<3>;
template decltype(likely_cause<2>) likely_cause<2>;
template decltype(likely_cause<3>) likely_cause<3>;

}  // namespace couplet::fluid
