// SPDX-License-Identifier: Apache-2.0
#include "mesh_mover/parameters.hpp"

namespace couplet::mesh_mover {

namespace {

void declare_boundary(config::Section& s, PatchMotion& b) {
  const auto nothing = [](config::Section&) {};
  s.variant(
      "type", b.motion,
      {{"interface", BoundaryMotion::interface, nothing},
       {"moving", BoundaryMotion::moving,
        [&b](config::Section& v) {
          v.section(
              "motion", [&b](config::Section& m) { couplet::fv::declare(m, b.prescribed, false); },
              "the motion of the patch, relative to the reference mesh");
        }},
       {"fixed", BoundaryMotion::fixed, nothing},
       {"slip", BoundaryMotion::slip, nothing},
       {"free", BoundaryMotion::free, nothing},
       {"periodic", BoundaryMotion::periodic,
        [&b](config::Section& v) {
          v.value("partner", b.partner)
              .required()
              .doc("the patch that is the translated copy of this one, as in the fluid");
        }}},
      "interface: moves with the structure; moving: moves as 'motion' prescribes; fixed: at rest; slip: "
      "slides along the patch (curved ones with method: pseudo-solid or barrier); free: follows the interior; "
      "periodic: moves as its partner, across which the mesh continues",
      true);
}

void declare_guard(config::Section& s, QualityLimits& g) {
  s.value("smallest-scaled-jacobian", g.smallest_scaled_jacobian)
      .range(-1, 1)
      .doc(
          "minimum scaled Jacobian of the cell corners: 1 at right angles (equal angles in simplices), 0 "
          "at a flat corner");
  s.value("largest-angle", g.largest_angle)
      .range(0, 90)
      .doc("angle between a face normal and the line of its cell centers [degree]");
}

void declare_method(config::Section& s, Parameters& p) {
  s.choice("method", p.method,
           {{"laplacian", Method::laplacian},
            {"pseudo-solid", Method::pseudo_solid},
            {"barrier", Method::barrier},
            {"auto", Method::automatic}})
      .doc(
          "laplacian: solves for each component separately and is the cheapest. pseudo-solid: an elastic body, which tolerates "
          "bending and rotation. barrier: minimizes a distortion of the cells that grows without bound as a cell flattens, so "
          "that cells cannot fold; costs several linear solves per motion. auto: laplacian, or barrier if the prescribed "
          "motions would invert a cell, or after the first motion that inverts one or folds it at a corner; laplacian with "
          "periodic patches");
  s.value("stiffening", p.stiffening)
      .range(0, 3)
      .doc("chi: the stiffness of a cell is its volume to the power -chi, so small cells deform less");
  s.value("poisson-ratio", p.poisson_ratio).range(-0.9, 0.45).doc("Poisson's ratio of the pseudo-solid");
}

}  // namespace

void declare(config::Section& section, Parameters& p) {
  section.value("mesh", p.mesh)
      .required()
      .doc("mesh file of the fluid (.msh, .geo to be meshed by gmsh, or a cut mesh, .h5)");
  section.value("mesh-scale", p.mesh_scale)
      .positive()
      .doc(
          "scale factor for all lengths of the mesh file: 0.001 for a mesh in millimeters; positions in "
          "keys remain in meters");
  section.value("mesh-parameters", p.mesh_parameters)
      .doc("values for names that the .geo defines with DefineConstant; the same as the fluid's");
  section.value("dimension", p.dimension).range(2, 3).required().doc("2 or 3 dimensions");
  declare_method(section, p);
  section.section(
      "guard", [&p](config::Section& g) { declare_guard(g, p.guard); },
      "further limits; a motion beyond one is rejected with the cell and its location, so the step is halved");
  section.map<PatchMotion>("boundaries", p.boundaries, declare_boundary, "patch",
                           "motion of the points of each patch of the mesh; every patch needs an entry");
  section.section(
      "linear-solver",
      [&](config::Section& s) {
        s.choice("method", p.linear.method,
                 {{"direct", linalg::LinearMethod::direct_symmetric},
                  {"cg-multigrid", linalg::LinearMethod::cg_multigrid}})
            .doc(
                "direct: one factorization for the whole run (best below about 100 000 cells; not available "
                "for a pseudo-solid in 3-D or with periodic patches). cg-multigrid: conjugate gradients "
                "with a reused multigrid preconditioner");
        s.value("relative-tolerance", p.linear.relative_tolerance)
            .range(1e-14, 1e-1)
            .doc("relative residual tolerance, for cg-multigrid");
        s.value("max-iterations", p.linear.max_iterations)
            .range(1, 100000)
            .doc("maximum number of iterations, for cg-multigrid");
      },
      "solution of the motion equations");
  section.check(
      [&p] {
        const bool joins = std::ranges::any_of(
            p.boundaries, [](const auto& b) { return b.second.motion == BoundaryMotion::periodic; });
        return joins && p.method == Method::barrier
                   ? "barrier is not available with periodic patches: use pseudo-solid, or type: slip for both patches"
                   : "";
      },
      "method");
}

}  // namespace couplet::mesh_mover
