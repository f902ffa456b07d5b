// SPDX-License-Identifier: Apache-2.0

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <set>
#include <utility>
#include <vector>

#include "common/base/error.hpp"
#include "common/log/log.hpp"
#include "common/parallel/collective.hpp"
#include "fluid_solver/step/fluid.hpp"

namespace couplet::fluid {

namespace {

/// Refuses what no scheme combines with this mesh or its motion. The first one that applies is told.
template <int D>
void check_effects(const mesh::Mesh& mesh, const FluidParameters& parameters, bool moving) {
  const bool frame = parameters.rotating_frame.has_value();
  bool across = false;
  const Vec3 axis =
      frame && D == 3 ? Vec3(parameters.rotating_frame->axis.normalized()) : Vec3(Vec3::UnitZ());
  for (const Vec3& shift : mesh.neighbour_shift)
    across = across || shift.cross(axis).norm() > 1e-6 * shift.norm();
  const struct {
    bool applies;
    const char* message;
  } refused[] = {
      {frame && moving,
       "rotating-frame: the mesh is at rest in the frame. Move the rotation to 'motion' (angle), or remove 'motion' and the "
       "mesh mover."},
      {frame && parallel::any(mesh.comm, across),
       "rotating-frame: the centrifugal force differs between periodic patches that are not shifted along the axis."}};
  for (const auto& [applies, message] : refused)
    if (applies) throw Error("{}", message);
}

/// `auto` becomes second order if fourth is not possible.
void check_order(FluidParameters& parameters, bool moving) {
  const auto [with, remove] = moving ? std::pair("a mesh that moves", "'motion' or the mesh mover")
                              : !parameters.bodies.empty() ? std::pair("immersed bodies", "'bodies'")
                              : !parameters.gaps.empty()   ? std::pair("gaps that close", "'gaps'")
                                                           : std::pair("", "");
  if (!*with) return;
  if (parameters.face_values == FaceValues::fourth_order)
    throw Error(
        "face-values: fourth-order is not supported together with {}; remove {}, or use second-order.", with,
        remove);
  log::info("Face values: second-order (auto: {})", with);
  parameters.face_values = FaceValues::second_order;
}

void check_axes(const FluidParameters& parameters, int dim) {
  for (const auto& [name, c] : parameters.output.coefficients)
    fv::check_axis(Vec3(c.axis[0], c.axis[1], std::abs(c.axis[2])), dim,  // a moment may be taken about -z
                   "output.coefficients." + name + ".axis");
}

/// Refuses parts of the fluid that no cell connects where one of them has no outlet. Collective.
template <int D>
void check_parts(const mesh::Mesh& mesh, const Boundary<D>& boundary) {
  std::vector<Index> root(mesh.cells.n_local());
  std::iota(root.begin(), root.end(), 0);
  const auto root_of = [&](Index c) {
    while (root[c] != c) c = root[c] = root[root[c]];
    return c;
  };
  for (Index f = 0; f < mesh.n_interior; ++f) {
    root[root_of(mesh.neighbour[f])] = root_of(mesh.owner[f]);
  }
  // A part has the number of its first cell, which ghost cells carry from rank to rank.
  std::vector<double> part(mesh.cell_id.begin(), mesh.cell_id.end());
  for (bool changes = true; parallel::any(mesh.comm, changes);) {
    for (Index c = 0; c < mesh.cells.n_local(); ++c) part[root_of(c)] = std::min(part[root_of(c)], part[c]);
    for (Index c = 0; c < mesh.cells.n_local(); ++c) part[c] = part[root_of(c)];
    const std::vector<double> before = part;
    mesh.cells.update_ghosts(part);
    changes = part != before;
  }
  double parts = 0;
  for (Index c = 0; c < mesh.cells.n_owned(); ++c) parts += part[c] == double(mesh.cell_id[c]);
  std::set<double> here;
  for (const Index b : boundary.rows().of_pressure) here.insert(part[mesh.owner[mesh.n_interior + b]]);
  const std::vector<double> all =
      parallel::all_gather(mesh.comm, std::vector<double>(here.begin(), here.end()));
  const auto open = double(std::set<double>(all.begin(), all.end()).size());
  parts = parallel::sum(mesh.comm, parts);
  if (parts > 1 && open < parts)
    throw Error(
        "boundaries: the mesh has {} parts that no cell connects, and {} of them have no outlet, which would set their "
        "pressure. Run each part as a participant of its own, or give each an outlet.",
        parts, parts - open);
}

}  // namespace

template <int D>
void check_together(const mesh::Mesh& mesh, const Boundary<D>& boundary, FluidParameters& parameters,
                    bool moving) {
  check_axes(parameters, D);
  check_parts(mesh, boundary);
  check_effects<D>(mesh, parameters, moving);
  if (parameters.face_values != FaceValues::second_order) check_order(parameters, moving);
  // Bodies act on the explicit step.
  if (!parameters.bodies.empty()) parameters.viscous = ViscousTreatment::explicit_;
}

template void check_together<2>(const mesh::Mesh&, const Boundary<2>&, FluidParameters&, bool);
template void check_together<3>(const mesh::Mesh&, const Boundary<3>&, FluidParameters&, bool);

}  // namespace couplet::fluid
