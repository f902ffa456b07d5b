// SPDX-License-Identifier: Apache-2.0
// The state that a run starts from.
#include "fluid_solver/motion/body_start.hpp"
#include "fluid_solver/step/fluid.hpp"

namespace couplet::fluid {

template <int D>
void Fluid<D>::start(const mesh::Geometry& geometry, double time) {
  State<D>& s = accepted_;
  s.time = time;
  if (path_.moves()) s.points = geometry.points;
  s.placement = path_.start(geometry);
  if (parameters_.face_values != FaceValues::second_order) s.placement = step_.raise_order(s.placement);
  sizes_.set_fourth(step_.fourth() != nullptr);
  const Placement<D>& at = *s.placement;
  s.u.assign(mesh_.cells.n_local(), Vec<D>::Zero());
  s.w.assign(mesh_.boundary.n_owned(), Vec<D>::Zero());
  s.u_boundary = s.w;
  if (!parameters_.initial_velocity.empty()) {
    const auto expressions = fv::make_expressions(parameters_.initial_velocity, D, "initial-velocity");
    for (int c = 0; c < D; ++c) {
      expressions[c].evaluate(geometry.cell_centre, time, flat<D>(s.u), D, c);
      expressions[c].evaluate(at.boundary_centre, time, flat<D>(s.u_boundary), D, c);
    }
  }
  // Without an initial velocity the fluid is at rest, its boundaries too: what they do from then on is an
  // impulse in the first step, which an elastic wall must feel. A given field is made to fit its boundaries
  // instead.
  s.start = parameters_.initial_velocity.empty() ? Start::at_rest : Start::flowing;
  if (s.start == Start::flowing) {
    boundary_.velocity_at(time, at.boundary_centre, s.w);
    if (boundary_.walls_turn()) {
      s.turn.assign(s.w.size(), Vec<D>::Zero());
      boundary_.add_turn(mesh_, geometry.points, time, s.turn);
      s.turns = true;
    }
    if (parameters_.motion)
      set_body_start(mesh_, geometry.points, boundary_, *parameters_.motion, time, s.w, s.turn);
  }
  for (std::size_t b = 0; b < s.w.size(); ++b)
    if (boundary_.is_convective(b)) s.w[b] = s.u_boundary[b];
  for (const Index b : boundary_.rows().of_pressure) s.u_boundary[b] = s.u[mesh_.owner[mesh_.n_interior + b]];
  step_.project_initial(s);
  const fv::Expression initial_pressure(parameters_.initial_pressure.value_or(config::ExpressionText{}),
                                        "initial-pressure");
  const bool is_state =
      parameters_.is_compressible() && (parameters_.initial_pressure || s.start == Start::at_rest);
  if (is_state || !initial_pressure.is_zero()) {
    auto level = std::make_shared<PressureLevel<D>>();
    level->time = time;
    level->p.resize(mesh_.cells.n_local());
    level->boundary.resize(s.w.size());
    initial_pressure.evaluate(geometry.cell_centre, time, level->p);
    initial_pressure.evaluate(at.boundary_centre, time, level->boundary);
    if (step_.frame()) add_centrifugal(*step_.frame(), at, -parameters_.density, *level);
    step_.start_level(at, *level);
    s.pressure[0] = level;
  }
  step_.start_waves(s);
  s.implicit = parameters_.viscous == ViscousTreatment::implicit;
  step_.set_eddy_viscosity(s);
  step_.keep();
}

template void Fluid<2>::start(const mesh::Geometry&, double);
template void Fluid<3>::start(const mesh::Geometry&, double);

}  // namespace couplet::fluid
