// SPDX-License-Identifier: Apache-2.0
// What ends a step of the fluid from outside: the motion of its walls; and what its coupling misses.
#include <cmath>
#include <limits>

#include "common/base/error.hpp"
#include "common/parallel/collective.hpp"
#include "fluid_solver/step/fluid.hpp"

namespace couplet::fluid {
namespace {

// An interface faster than so many times all that moved so far (at the very start: than this [m/s]) diverges.
constexpr double most_times_faster = 1e4, most_speed = 1e8;

}  // namespace

/// The layer that a wall drags along within a step is rho sqrt(nu dt) thick: a mass that acts on w* in the
/// loop, see docs/theory.md.
template <int D>
double Fluid<D>::unseen_share(const Vectors<D>& w) const {
  const double layer = std::sqrt(parameters_.density * parameters_.viscosity / dt_);  // rho sqrt(nu dt)/dt
  double sums[4] = {};  // unseen^2, load^2, load.S, S^2
  for (std::size_t b = 0; b < guess_.size(); ++b) {
    if (!boundary_.is_interface(static_cast<Index>(b))) continue;
    const Vec<D>& area = level().placement->area[mesh_.n_interior + static_cast<Index>(b)];
    const Vec<D> load = pressure_force_[b] + viscous_force_[b];
    sums[0] += layer * layer * area.squaredNorm() * (w[b] - guess_[b]).squaredNorm();
    sums[1] += load.squaredNorm();
    sums[2] += load.dot(area);
    sums[3] += area.squaredNorm();
  }
  MPI_Allreduce(MPI_IN_PLACE, sums, 4, MPI_DOUBLE, MPI_SUM, mesh_.comm);
  const double load = sums[3] > 0 ? sums[1] - sums[2] * sums[2] / sums[3] : 0;
  return load > 0 ? std::sqrt(sums[0] / load) : 0;
}

/// A structure that fails gives velocities that no fluid can follow. What moves less than the height of the cell
/// beside it in the step is none of these, however still the fluid was; nor are bodies that move as prescribed.
template <int D>
void Fluid<D>::check_wall_velocity() const {
  double worst = 0;
  Index where = -1;
  for (const std::string& name : boundary_.interface_patches()) {
    const mesh::Patch& patch = *mesh_.find_patch(name);
    for (Index f = patch.first; f < patch.first + patch.count; ++f) {
      const Index b = f - mesh_.n_interior;
      const double square = last_w_[b].squaredNorm();
      const double height = 2 * step_.to().area[f].norm() / step_.to().conductance[f];
      if (square <= worst || std::sqrt(square) * dt_ <= height) continue;
      worst = std::isfinite(square) ? square : std::numeric_limits<double>::infinity();
      where = b;
    }
  }
  const double limit = step_.largest_speed() > 0 ? most_times_faster * step_.largest_speed() : most_speed;
  if (!parallel::any(mesh_.comm, !(std::sqrt(worst) <= limit))) return;
  struct {
    double value;
    int rank;
  } first{worst, parallel::comm_rank(mesh_.comm)};
  MPI_Allreduce(MPI_IN_PLACE, &first, 1, MPI_DOUBLE_INT, MPI_MAXLOC, mesh_.comm);
  Vec3 place = where < 0 ? Vec3(Vec3::Zero()) : level().placement->boundary_centre[where];
  MPI_Bcast(place.data(), 3, MPI_DOUBLE, first.rank, mesh_.comm);
  throw SolveFailure(
      "The velocity of the interface {} at t = {:.6g} s near ({:.6g}, {:.6g}, {:.6g}) m: the structure or "
      "the coupling diverges.",
      std::isfinite(first.value) ? fmt::format("is {:.3g} m/s", std::sqrt(first.value)) : "is not finite",
      time_ + dt_, place.x(), place.y(), place.z());
}

template double Fluid<2>::unseen_share(const Vectors<2>&) const;
template void Fluid<2>::check_wall_velocity() const;
template double Fluid<3>::unseen_share(const Vectors<3>&) const;
template void Fluid<3>::check_wall_velocity() const;

}  // namespace couplet::fluid
