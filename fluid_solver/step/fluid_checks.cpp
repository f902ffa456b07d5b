// SPDX-License-Identifier: Apache-2.0
#include "fluid_solver/step/fluid_checks.hpp"

#include <Eigen/Geometry>
#include <cmath>
#include <utility>

#include "common/base/error.hpp"
#include "common/log/log.hpp"
#include "common/parallel/collective.hpp"

namespace couplet::fluid {

namespace {

template <int D>
void check_frame(const mesh::Mesh& mesh, const Boundary<D>& boundary, const FluidParameters& parameters,
                 bool moving) {
  if (!parameters.rotating_frame) return;
  const auto refuse = [](const char* what) { throw Error("rotating-frame: {}", what); };
  if (moving)
    refuse(
        "the mesh is at rest in the frame. Move the rotation to 'motion' (angle), or remove 'motion' and "
        "the mesh mover.");
  if (!boundary.interface_patches().empty())
    refuse("no structure supports a rotating frame: boundaries of type interface are not allowed.");
  if (!parameters.bodies.empty()) refuse("immersed bodies do not support it; remove 'bodies'.");
  if (parameters.scheme == ExplicitScheme::runge_kutta)
    refuse("its forces are extrapolated from step to step: use 'scheme: adams-bashforth'.");
  const RotationParameters& frame = *parameters.rotating_frame;
  const Vec3 axis = D == 2 ? Vec3(Vec3::UnitZ()) : Vec3(frame.axis.normalized());
  bool across = false;
  for (const Vec3& shift : mesh.neighbour_shift)
    across = across || shift.cross(axis).norm() > 1e-6 * shift.norm();
  if (parallel::any(mesh.comm, across))
    refuse("the centrifugal force differs between periodic patches that are not shifted along the axis.");
}

void check_waves(const FluidParameters& parameters) {
  const auto refuse = [](const char* with, const char* remove) {
    throw Error("compressibility: not supported together with {}; remove {}, or set 'scheme: none'.", with,
                remove);
  };
  if (!parameters.bodies.empty()) refuse("immersed bodies", "'bodies'");
  if (parameters.rotating_frame) refuse("a rotating frame", "'rotating-frame'");
  if (parameters.scheme == ExplicitScheme::runge_kutta)
    refuse("the stages of runge-kutta", "'scheme: runge-kutta'");
}

/// `auto` becomes second order where fourth is not possible.
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

void check_sides(const FluidParameters& parameters) {
  for (const auto& [name, b] : parameters.boundaries)
    if (b.sides == Sides::together)
      throw Error(
          "boundaries.{}.sides: together needs an outlet, since in a closed fluid the level of the pressure depends on "
          "each side by itself; use 'auto' or 'apart'.",
          name);
}

void check_axes(const FluidParameters& parameters, int dim) {
  if (parameters.rotating_frame) fv::check_axis(parameters.rotating_frame->axis, dim, "rotating-frame.axis");
  for (const auto& [name, b] : parameters.boundaries)
    if (b.rotation) fv::check_axis(b.rotation->axis, dim, "boundaries." + name + ".rotation.axis");
  for (const auto& [name, c] : parameters.output.coefficients)
    fv::check_axis(Vec3(c.axis[0], c.axis[1], std::abs(c.axis[2])), dim,  // a moment may be taken about -z
                   "output.coefficients." + name + ".axis");
}

}  // namespace

FluidParameters with_surfaces(FluidParameters parameters, bool moving) {
  BodySurface all = BodySurface::automatic;
  for (const auto& [name, body] : parameters.bodies) {
    if (body.surface == BodySurface::automatic) continue;
    if (all != BodySurface::automatic && body.surface != all)
      throw Error("bodies.{}.surface: all bodies have the same kind of surface; choose steps or cut.", name);
    all = body.surface;
  }
  if (all == BodySurface::automatic) all = moving ? BodySurface::cut : BodySurface::steps;
  for (auto& [name, body] : parameters.bodies) body.surface = all;
  return parameters;
}

template <int D>
void check_together(const mesh::Mesh& mesh, const Boundary<D>& boundary, FluidParameters& parameters,
                    bool moving) {
  check_axes(parameters, D);
  check_frame(mesh, boundary, parameters, moving);
  if (boundary.closed()) check_sides(parameters);
  if (!parameters.bodies.empty()) {
    if (!parameters.gaps.empty())
      throw Error("gaps: not supported together with immersed bodies; remove 'gaps' or 'bodies'.");
    if (boundary.closed())
      throw Error("bodies: a fluid with immersed bodies needs an outlet, because they may displace fluid.");
    if (parameters.bodies.begin()->second.surface == BodySurface::cut &&
        parameters.projection == Projection::incremental)
      throw Error(
          "projection: incremental does not know cells that bodies cut; use flux-memory, or on a mesh at rest "
          "'surface: steps' of the bodies.");
    if (parameters.viscous == ViscousTreatment::implicit)
      throw Error("viscous: implicit is not possible with immersed bodies, which act on the explicit step.");
    parameters.viscous = ViscousTreatment::explicit_;
  }
  if (parameters.face_values != FaceValues::second_order) check_order(parameters, moving);
  if (parameters.is_compressible()) check_waves(parameters);
  if (!parameters.gaps.empty() && boundary.closed() && !parameters.is_compressible())
    throw Error(
        "gaps: a fluid with closing gaps needs an outlet, because its blocked cells retain their "
        "fluid.");
  if (parameters.scheme != ExplicitScheme::runge_kutta) return;
  if (moving) throw Error("scheme: runge-kutta needs a mesh at rest; use adams-bashforth with a mesh mover.");
  if (parameters.viscous == ViscousTreatment::implicit)
    throw Error(
        "scheme: runge-kutta treats the viscous term explicitly; use 'viscous: explicit' or adams-bashforth.");
  parameters.viscous = ViscousTreatment::explicit_;
}

template void check_together<2>(const mesh::Mesh&, const Boundary<2>&, FluidParameters&, bool);
template void check_together<3>(const mesh::Mesh&, const Boundary<3>&, FluidParameters&, bool);

}  // namespace couplet::fluid
