// SPDX-License-Identifier: Apache-2.0
// Fluids without an outlet.
#include <algorithm>
#include <cmath>

#include "common/base/error.hpp"
#include "fluid_solver/pressure/projection.hpp"

namespace couplet::fluid {
namespace {

// A closed domain: share of the boundary fluxes that a moving wall may leave over as an error of
// discretisation, and the speed below which there is no flow [m/s].
// What walls that only move along themselves leave over of their speeds is the error of these.
constexpr double largest_leftover = 0.1, least_speed = 1e-9, round_speed = 1e-6;

}  // namespace

// An incompressible fluid without an outlet needs boundary fluxes that add up to nothing. What a moving wall
// leaves over (discretisation error) is spread over the interface, or over all moving faces, by their area;
// at a convective outlet what flows in elsewhere has to leave.
template <int D>
void PressureProjection<D>::balance_closed_domain() {
  enum { total, size, adjustable_area, other_area, speeds };
  double sums[5] = {};
  for (std::size_t b = 0; b < k_.w.size(); ++b) {
    const Index f = k_.mesh.n_interior + static_cast<Index>(b);
    const double area = k_.step.to->area[f].norm();
    sums[total] += k_.phi_p[f];
    sums[size] += std::abs(k_.phi_p[f]);
    sums[speeds] += k_.w[b].norm() * area;
    sums[k_.boundary.is_adjustable(b) ? adjustable_area : other_area] += area;
  }
  MPI_Allreduce(MPI_IN_PLACE, sums, 5, MPI_DOUBLE, MPI_SUM, k_.mesh.comm);
  const bool adjustable = sums[adjustable_area] > 0;
  // Walls that turn let nothing through but round-off of their speeds.
  if (!adjustable && std::abs(sums[total]) > std::max(1e-6 * sums[size], 1e-12 * sums[speeds]))
    throw Error(
        "The fluid domain is closed, but the prescribed velocities give a net outflow of {:.6g} m^3/s. Add "
        "an outlet or correct the velocities.",
        sums[total]);
  // With a level that holds the volume, or walls that yield to one, only guesses of the wall's motion leave so much over.
  if (adjustable && !k_.boundary.has_convective_outlet() &&
      k_.parameters.volume_level == VolumeLevelBy::nobody && !k_.boundary.yields() &&
      std::abs(sums[total]) > largest_leftover * sums[size] &&
      std::abs(sums[total]) > round_speed * sums[speeds] &&
      sums[size] > least_speed * (sums[adjustable_area] + sums[other_area]))
    throw Error(
        "The fluid domain is closed: at t = {:.6g} s the net outflow is {:.6g} m^3/s, which neither the "
        "prescribed velocities nor the interface motion balance. The pressure level that would push it "
        "through the interface is not computed: add an outlet (a small one far from the interface is "
        "enough).",
        k_.by.time + k_.step.dt, sums[total]);
  const double correction = sums[total] / (adjustable ? sums[adjustable_area] : sums[other_area]);
  for (std::size_t b = 0; b < k_.w.size(); ++b) {
    const Index f = k_.mesh.n_interior + static_cast<Index>(b);
    if (adjustable && !k_.boundary.is_adjustable(b)) continue;
    k_.phi_p[f] -= correction * k_.step.to->area[f].norm();
    if (k_.boundary.is_convective(b)) k_.w[b] -= correction * k_.step.to->area[f].normalized();
  }
}

template void PressureProjection<2>::balance_closed_domain();
template void PressureProjection<3>::balance_closed_domain();

}  // namespace couplet::fluid
