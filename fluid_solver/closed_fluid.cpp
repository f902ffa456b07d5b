// SPDX-License-Identifier: Apache-2.0
// Walls that the mesh moves although they rest, and fluids without an outlet, whose walls may change the volume.
#include <array>
#include <cmath>
#include <span>

#include "common/base/error.hpp"
#include "common/parallel/collective.hpp"
#include "fluid_solver/participant.hpp"

namespace couplet::fluid {
namespace {

// Net part of what the walls displace that may be an error of discretisation, and the change of volume that is
// round-off. A chord of a twentieth of a turn misses 1.6 % of what lies between it and the center.
constexpr double largest_leftover = 0.02, round_off = 1e-12;
constexpr double allowed = 1e-10;  // change of volume that remains

// Largest normal part of the motion of points that slide along a wall at rest, and the part of the largest motion in
// the mesh that is its tail.
constexpr double slides = 0.3, tail = 1e-3;

// Largest share of an interface's area that faces one way for it to enclose a body; above, it is a cavity
// wall.
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

/// Inflow through faces of given velocity except the interface's [m^3/s]; this rank's part.
template <int D>
double given_inflow(const Fluid<D>& fluid, const Placement<D>& at, double t) {
  const Boundary<D>& boundary = fluid.boundary();
  Vectors<D> w(boundary.rows().pressure.size(), Vec<D>::Zero());  // stays so at the interface
  boundary.velocity_at(t, fluid.mesh(), at, w);
  double inflow = 0;
  for (const Index b : boundary.rows().of_velocity) inflow -= w[b].dot(at.area[fluid.mesh().n_interior + b]);
  return inflow;
}

}  // namespace

template <int D>
void check_walls_at_rest(const Fluid<D>& fluid, std::span<const Vec3> points, double time, bool coupled) {
  const mesh::Mesh& mesh = fluid.mesh();
  const std::vector<Vec3>& before =
      fluid.state().points.empty() ? fluid.points_at_rest() : fluid.state().points;
  double largest = 0;  // motion of any point in this step [m]
  for (std::size_t v = 0; v < points.size(); ++v) largest = std::max(largest, (points[v] - before[v]).norm());
  largest = parallel::max(mesh.comm, largest);
  for (const mesh::Patch& patch : mesh.patches) {
    const FlowCondition& condition = condition_of(fluid.parameters().boundaries.at(patch.name));
    const bool rests =
        condition.velocity == GivenBy::rest || (condition.velocity == GivenBy::structure && !coupled);
    if (!condition.wall || !rests) continue;
    double along = 0, most = 0;  // [m]
    for (Index f = patch.first; f < patch.first + patch.count; ++f) {
      Vec3 moved = Vec3::Zero();
      for (const Index v : mesh.face_points[f]) {
        moved += (points[v] - before[v]) / double(mesh.face_points[f].size());
        most = std::max(most, (points[v] - before[v]).norm());
      }
      const Vec<D>& area = fluid.state().placement->area[f];
      along = std::max(along, std::abs(moved.template head<D>().dot(area)) / area.norm());
    }
    along = parallel::max(mesh.comm, along), most = parallel::max(mesh.comm, most);
    if (along > slides * most && along > tail * largest)
      throw Error(
          "boundaries.{0}: in the step to t = {1:.6g} s the mesh moves this wall along its normal by {2:.3g} m, but a wall of "
          "type {3} stays at rest, so that the fluid would pass through it. A wall that moves with the mesh has 'type: body'.",
          patch.name, time, along, condition.name);
  }
}

template <int D>
void keep_volume(const Fluid<D>& fluid, std::vector<Vec3>& points, double time) {
  const mesh::Mesh& mesh = fluid.mesh();
  const Boundary<D>& boundary = fluid.boundary();
  if (points.empty() || !boundary.sealed() || boundary.yields() || fluid.parameters().is_compressible() ||
      fluid.parameters().volume_level != VolumeLevelBy::nobody)
    return;
  const auto balance = [&](std::span<const Vec3> to) {
    const std::vector<double> swept = mesh::swept_volumes(mesh, fluid.points_at_rest(), to);
    std::array<double, 2> sums{};  // net, gross
    for (Index f = mesh.n_interior; f < mesh.n_flux_faces(); ++f)
      sums[0] += swept[f], sums[1] += std::abs(swept[f]);
    MPI_Allreduce(MPI_IN_PLACE, sums.data(), 2, MPI_DOUBLE, MPI_SUM, mesh.comm);
    return sums;
  };
  double volume = 0;
  for (Index c = 0; c < mesh.cells.n_owned(); ++c) volume += fluid.state().placement->volume[c];
  volume = parallel::sum(mesh.comm, volume);
  auto [net, gross] = balance(points);
  if (!(std::abs(net) > round_off * volume)) return;
  const auto refuse = [&] {
    throw Error(
        "The fluid has no outlet, but at t = {:.6g} s its walls have changed its volume by {:.6g} m^3, {:.2g} of what they "
        "displace (limit {:g}): an incompressible fluid keeps its volume. Correct the motion of the walls, add an outlet (a small "
        "one is enough), or set 'compressibility'.",
        time, net, std::abs(net) / gross, largest_leftover);
  };
  if (std::abs(net) > largest_leftover * gross && std::abs(net) > allowed * volume) refuse();
  if (!boundary.interface_patches().empty()) return;
  const std::shared_ptr<const Placement<D>> at = make_placement<D>(mesh, points);
  Vectors<D> normal(points.size(), Vec<D>::Zero());
  double area = 0;
  for (const mesh::Patch* patch : boundary.body_patches())
    for (Index f = patch->first; f < patch->first + patch->count; ++f) {
      area += at->area[f].norm();
      for (const Index v : mesh.face_points[f]) normal[v] += at->area[f];
    }
  area = parallel::sum(mesh.comm, area);
  mesh.points.add_to_owners(flat<D>(normal), D);
  mesh.points.update_ghosts(flat<D>(normal), D);
  for (Vec<D>& n : normal) n.stableNormalize();
  const std::vector<Vec3> given = points;
  double set_back = 0, slope = area;  // [m], [m^2]
  for (int pass = 0; pass < 8 && std::abs(net) > round_off * volume && slope > 0; ++pass) {
    const double before = net, change = -net / slope;
    set_back += change;
    for (std::size_t v = 0; v < points.size(); ++v)
      points[v].template head<D>() = given[v].template head<D>() + set_back * normal[v];
    net = balance(points)[0];
    if (std::abs(net) < 0.5 * std::abs(before)) slope = (net - before) / change;
  }
  if (std::abs(net) > allowed * volume) refuse();
}

template <int D>
void check_cavity(const Fluid<D>& fluid, coupling::Scheme scheme) {
  const Boundary<D>& boundary = fluid.boundary();
  const bool closed = boundary.closed() && !boundary.has_convective_outlet(),
             alone = scheme == coupling::Scheme::standalone, waves = fluid.parameters().is_compressible(),
             walled = !boundary.interface_patches().empty();
  if (fluid.parameters().volume_level == VolumeLevelBy::structure) {
    if (alone)
      throw Error("volume-level: structure: this fluid runs alone, without a structure; remove the key.");
    return;
  }
  const bool is_set = alone || !closed || !walled || boundary.yields() || waves;
  if (is_set) return;
  const auto [share, area] = open_share(fluid);
  if (share <= largest_open_share) return;
  throw Error(
      "boundaries: this fluid has no outlet, and its interface is a wall of the cavity ({:.3g} of its area {:.3g} m^2 faces "
      "one way): it could move only by changing the volume of an incompressible fluid. The pressure level that conserves the "
      "volume is not computed; set 'volume-level: structure', or add an outlet (a small one far from the interface is enough).",
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

template decltype(check_walls_at_rest<2>) check_walls_at_rest<2>;
template decltype(check_walls_at_rest<3>) check_walls_at_rest<3>;
template decltype(keep_volume<2>) keep_volume<2>;
template decltype(keep_volume<3>) keep_volume<3>;
template void check_cavity(const Fluid<2>&, coupling::Scheme);
template void check_cavity(const Fluid<3>&, coupling::Scheme);
template std::vector<double> inflow_shares(const Fluid<2>&, const std::vector<Index>&, double, double);
template std::vector<double> inflow_shares(const Fluid<3>&, const std::vector<Index>&, double, double);

}  // namespace couplet::fluid
