// SPDX-License-Identifier: Apache-2.0
// A sheet of large strain whose end a partner pulls.
#pragma once

#include "tests/verification/solid/support.hpp"

namespace couplet::testing {

inline SolidParameters pushed(time::TimeScheme scheme) {
  SolidParameters p = box_parameters(2);
  p.analysis = SolidParameters::Analysis::dynamic;
  p.kinematics = SolidParameters::Kinematics::finite_strain;
  p.material = {1000, 2e4, 0.3};
  p.time_scheme.type = scheme;
  p.boundaries["xmin"] = clamped(2);
  p.boundaries["xmax"] = boundary(Type::interface_);
  return p;
}

inline std::unique_ptr<Solid> sheet(time::TimeScheme scheme) {
  return make_solid(mesh::make_box(mesh::BoxCells::quadrilaterals, {5, 2, 1}, Vec3::Zero(), Vec3(1, 0.4, 0)),
                    pushed(scheme));
}

/// One accepted step; `traction`: across, at the end [Pa].
inline void step_under(Solid& solid, const coupling::Interface& interface, double dt, double traction) {
  const double t = solid.stepper().state().time;
  std::vector<double> force;
  for (const Vec3& area : interface.face_areas) force.insert(force.end(), {0, area.norm() * traction});
  const std::vector<double> still(force.size(), 0);
  solid.begin_step({t, dt, coupling::Scheme::semi_implicit, solid.stepper().state().steps});
  solid.solve({{"pressure-force", force}, {"viscous-force", still}});
  solid.accept_step();
}

}  // namespace couplet::testing
