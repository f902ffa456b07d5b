// SPDX-License-Identifier: Apache-2.0
#include "mesh_mover/parameters.hpp"

namespace couplet::mesh_mover {

void declare(config::Section& section, Parameters& p) {
  section.value("mesh", p.mesh).required().doc("mesh file of the fluid (.msh, or .geo to be meshed by gmsh)");
  section.value("mesh-parameters", p.mesh_parameters)
      .doc("numbers for names that the .geo defines by DefineConstant; the same as the fluid's");
  section.value("dimension", p.dimension).range(2, 3).required().doc("2 or 3");
  section.value("stiffening", p.stiffening)
      .range(0, 3)
      .doc(
          "chi: stiffness of a cell is its reference volume to the power -chi, so that small cells deform "
          "less");
  section.value("smallest-volume-ratio", p.smallest_volume_ratio)
      .range(0, 1)
      .doc(
          "a motion that leaves a cell less than this share of its reference volume is refused (0: only "
          "inverted "
          "cells are)");
  section.map<Boundary>(
      "boundaries", p.boundaries,
      [](config::Section& s, Boundary& b) {
        s.choice("type", b.motion,
                 {{"interface", BoundaryMotion::interface},
                  {"fixed", BoundaryMotion::fixed},
                  {"slip", BoundaryMotion::slip}})
            .required()
            .doc("interface: moves with the structure; fixed: stays; slip: slides along its plane");
      },
      "patch", "how the points of each patch of the mesh move; every patch needs an entry");
  section.section(
      "linear-solver",
      [&](config::Section& s) {
        s.choice("method", p.linear.method,
                 {{"direct", LinearMethod::direct_symmetric}, {"cg-multigrid", LinearMethod::cg_multigrid}})
            .doc(
                "direct: one factorisation for the whole run (best below about 100 000 cells); cg-multigrid: "
                "conjugate gradients with a kept multigrid preconditioner");
        s.value("relative-tolerance", p.linear.relative_tolerance)
            .range(1e-14, 1e-1)
            .doc("of the residual, for cg-multigrid");
        s.value("max-iterations", p.linear.max_iterations).range(1, 100000).doc("for cg-multigrid");
      },
      "how the motion equations are solved");
}

}  // namespace couplet::mesh_mover
