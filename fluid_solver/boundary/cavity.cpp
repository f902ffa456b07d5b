// SPDX-License-Identifier: Apache-2.0
// Fluids without an outlet whose walls move.
#include "fluid_solver/boundary/cavity.hpp"

#include "common/base/error.hpp"
#include "common/parallel/collective.hpp"

namespace couplet::fluid {
namespace {

// Of the area of an interface: up to here it surrounds a body (the rest is where that is clamped), beyond it
// is the wall of a cavity.
constexpr double largest_open_share = 0.3;

/// Share of the interface's area that faces one way, and the area [m^2].
template <int D>
std::pair<double, double> open_share(const Fluid<D>& fluid) {
  double sums[4] = {};  // S, |S|
  for (const std::string& name : fluid.boundary().interface_patches()) {
    const mesh::Patch& patch = *fluid.mesh().find_patch(name);
    for (Index f = patch.first; f < patch.first + patch.count; ++f) {
      const Vec<D>& area = fluid.state().placement->area[f];
      for (int c = 0; c < D; ++c) sums[c] += area[c];
      sums[3] += area.norm();
    }
  }
  MPI_Allreduce(MPI_IN_PLACE, sums, 4, MPI_DOUBLE, MPI_SUM, fluid.mesh().comm);
  return {Vec3(sums[0], sums[1], sums[2]).norm() / sums[3], sums[3]};
}

/// Through the faces of given velocity but the interface's, into the fluid [m^3/s]; this rank's part.
template <int D>
double given_inflow(const Fluid<D>& fluid, const Placement<D>& at, double t) {
  const Boundary<D>& boundary = fluid.boundary();
  Vectors<D> w(boundary.rows().pressure.size(), Vec<D>::Zero());  // stays so at the interface
  boundary.velocity_at(t, at.boundary_centre, w);
  double inflow = 0;
  for (const Index b : boundary.rows().of_velocity) inflow -= w[b].dot(at.area[fluid.mesh().n_interior + b]);
  return inflow;
}

}  // namespace

template <int D>
void check_cavity(const Fluid<D>& fluid, coupling::Scheme scheme) {
  const Boundary<D>& boundary = fluid.boundary();
  const bool closed = boundary.closed() && !boundary.has_convective_outlet();
  if (fluid.parameters().volume_level == VolumeLevelBy::structure) {
    if (scheme == coupling::Scheme::standalone)
      throw Error("volume-level: structure: this fluid runs alone, without a structure; remove the key.");
    if (fluid.parameters().is_compressible())
      throw Error(
          "volume-level: structure: a compressible fluid has a pressure level of its own; remove the key.");
    if (boundary.yields())
      throw Error(
          "volume-level: structure: walls with a surface-density get their level from the pressure "
          "equation; remove one of the two keys.");
    if (!closed || boundary.interface_patches().empty() || !boundary.body_patches().empty())
      throw Error(
          "volume-level: structure: this fluid {}, so a structure cannot set its pressure level; remove the "
          "key.",
          !closed                           ? "has an outlet"
          : boundary.body_patches().empty() ? "has no wall of type interface"
                                            : "has bodies that move as prescribed");
    return;
  }
  if (scheme == coupling::Scheme::standalone || !closed || boundary.interface_patches().empty() ||
      boundary.yields() || fluid.parameters().is_compressible())
    return;
  const auto [share, area] = open_share(fluid);
  if (share <= largest_open_share) return;
  throw Error(
      "boundaries: this fluid has no outlet, and its interface is a wall of the cavity ({:.3g} of its area "
      "{:.3g} m^2 faces one way): it could move only by changing the volume of an incompressible fluid. The "
      "pressure level that conserves the volume is not computed; set 'volume-level: structure', or add an "
      "outlet (a small one far from the interface is enough).",
      share, area);
}

template <int D>
std::vector<double> inflow_shares(const Fluid<D>& fluid, const std::vector<Index>& faces, double time,
                                  double dt) {
  const Placement<D>& begin = *fluid.state().placement;
  double sums[3] = {given_inflow(fluid, fluid.end(), time + dt), given_inflow(fluid, begin, time), 0};
  for (const Index f : faces) sums[2] += begin.area[f].norm();
  MPI_Allreduce(MPI_IN_PLACE, sums, 3, MPI_DOUBLE, MPI_SUM, fluid.mesh().comm);
  std::vector<double> shares;
  for (const Index f : faces) {
    const double share = begin.area[f].norm() / sums[2];
    shares.insert(shares.end(), {share * sums[0], share * sums[1]});
  }
  return shares;
}

template void check_cavity(const Fluid<2>&, coupling::Scheme);
template void check_cavity(const Fluid<3>&, coupling::Scheme);
template std::vector<double> inflow_shares(const Fluid<2>&, const std::vector<Index>&, double, double);
template std::vector<double> inflow_shares(const Fluid<3>&, const std::vector<Index>&, double, double);

}  // namespace couplet::fluid
