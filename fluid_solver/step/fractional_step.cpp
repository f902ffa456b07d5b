// SPDX-License-Identifier: Apache-2.0
// The parts of a fractional step in their order.
#include "fluid_solver/step/fractional_step.hpp"

#include <algorithm>

#include "common/log/log.hpp"
#include "common/parallel/collective.hpp"
#include "fluid_solver/motion/seat_check.hpp"

namespace couplet::fluid {
namespace {

constexpr double least_share = 0.5;  // of cells and directions that have lines, for which fourth order pays

}  // namespace

template <int D>
FractionalStep<D>::FractionalStep(const mesh::Mesh& mesh, const std::vector<Vec3>& points_at_rest,
                                  const Boundary<D>& boundary, const FluidParameters& parameters, bool moving)
    : k_{mesh,
         points_at_rest,
         boundary,
         parameters,
         parameters.density,
         parameters.viscosity / parameters.density,
         parameters.sound_speed()},
      predictor_(k_),
      flux_(k_),
      projection_(k_, moving),
      loads_(k_),
      energy_guard_(mesh, boundary, parameters.density, parameters.viscosity, parameters.pressure_tolerance,
                    k_.sound) {
  if (parameters.rotating_frame) k_.frame.emplace(*parameters.rotating_frame);
  if (!parameters.bodies.empty()) k_.bodies = std::make_unique<ImmersedBodies<D>>(mesh, parameters);
  if (parameters.gaps.empty()) return;
  check_seats(mesh, parameters, points_at_rest);
  k_.gaps = std::make_unique<Gaps<D>>(mesh, parameters);
  k_.pockets = std::make_unique<GapPockets<D>>(mesh, parameters);
}

template <int D>
std::shared_ptr<const Placement<D>> FractionalStep<D>::raise_order(std::shared_ptr<const Placement<D>> at) {
  Lines<D> lines(k_.mesh, *at);
  if (k_.parameters.face_values == FaceValues::automatic) {
    const bool pays = lines.share >= least_share;
    log::info("Face values: {} (auto: fourth order is possible on {:.0f} % of the mesh)",
              pays ? "fourth-order" : "second-order", 100 * lines.share);
    if (!pays) return at;
  }
  auto seen = lines.seen(k_.mesh, *at);
  k_.fourth = std::make_unique<FourthOrder<D>>(k_.mesh, std::move(lines));
  predictor_.rate_operator().set_fourth(k_.fourth.get());
  return seen;
}

template <int D>
void FractionalStep<D>::predict(const State<D>& from, const History<D>& by, SubStep<D> step,
                                const Vectors<D>& w) {
  k_.step = std::move(step);
  k_.by = by;
  level_.reset();
  k_.w = w;
  const bool moving = !k_.step.swept.empty();
  if (moving)
    for (const Index b : k_.boundary.rows().of_mesh) {
      const Index f = k_.mesh.n_interior + b;
      k_.w[b] = k_.step.swept[f] / (k_.step.dt * k_.step.to->area[f].squaredNorm()) * k_.step.to->area[f];
    }
  if (k_.bodies) projection_.mark_bodies(k_.by.time + k_.step.dt);
  if (k_.gaps && moving) projection_.mark_gaps();
  k_.gap_changed = k_.gaps && k_.gaps->differs(from.blocked.get());
  if (k_.gap_closed()) {
    k_.pockets->check(*k_.step.to, k_.w, k_.by.time + k_.step.dt, k_.sound > 0);
    k_.gaps->follow(*from.placement, *k_.step.to, k_.step.dt);
  }
  predictor_.predict(from);
  loads_.remember_prediction(predictor_.weight());
  k_.mesh.cells.update_ghosts(flat<D>(k_.u_p), D);
  if (k_.bodies) k_.bodies->force(*k_.step.to, k_.step.dt, k_.u_p);
  if (k_.gap_closed()) k_.gaps->hold(k_.u_p);
  projection_.extrapolate_pressure();
  projection_.prepare_waves(from);
  flux_.predict(from);
  if (k_.gap_closed()) projection_.block_gaps(k_.phi_orthogonal);
  projection_.assemble();
}

template <int D>
void FractionalStep<D>::rates(const State<D>& of, Vectors<D>& rate, Vectors<D>& shear) {
  predictor_.set_rates(of, false);
  rate = predictor_.rates().rate;
  shear = predictor_.shear();
}

template <int D>
void FractionalStep<D>::project(const State<D>& from, const Vectors<D>& w, double answer) {
  level_.reset();
  projection_.project(from, w, answer);
  loads_.set_forces(from);
}

template <int D>
void FractionalStep<D>::mark_level(State<D>& s) {
  if (!k_.gaps && !k_.bodies) return;
  k_.step.to = s.placement;
  k_.step.points = s.points;
  k_.step.swept.clear();
  if (k_.bodies) projection_.mark_bodies(s.time);
  if (!k_.gaps) return;
  projection_.mark_gaps();
  k_.gaps->follow(*s.placement, *s.placement, 0);
  s.blocked = k_.gaps->marks();
}

/// u = u0 - grad psi with phi free of divergence: the same equation with dt = 1 s, rho = 1. Where the given
/// wall velocity differs from u0 at the wall (an inlet that starts at once) the field becomes the potential
/// flow.
template <int D>
void FractionalStep<D>::project_initial(State<D>& s) {
  k_.oblique = parallel::max(k_.mesh.comm, s.placement->obliqueness) > orthogonal ||
               (!s.points.empty() && !s.placement->shape);
  const Placement<D>& at = *s.placement;
  projection_.set_obliqueness(at);
  k_.phi_p.assign(k_.mesh.n_flux_faces(), 0.0);
  k_.step = {k_.rho, s.placement, {}, s.points};  // dt/rho = 1
  mark_level(s);
  if (k_.bodies) k_.bodies->force(at, k_.step.dt, s.u);
  mean_flux<D>(k_.mesh, at, k_.flux_velocity(at, s.u), s.u_boundary, k_.velocity_gradient, k_.phi_p);
  if (k_.bodies && k_.bodies->cuts()) k_.bodies->carry_to_open(at, s.u, k_.phi_p);
  for (std::size_t b = 0; b < s.w.size(); ++b)
    k_.phi_p[k_.mesh.n_interior + b] = s.u_boundary[b].dot(at.area[k_.mesh.n_interior + b]);
  k_.by = s;
  k_.right_side.resize(s.u.size());
  if (k_.bodies)
    for (Index f = 0; f < k_.mesh.n_flux_faces(); ++f) k_.phi_p[f] = k_.open_flux(f, k_.phi_p[f]);
  if (k_.gap_closed()) {
    k_.gaps->hold(s.u);
    projection_.block_gaps(k_.phi_p);
  }
  k_.w = s.w;
  k_.gradient_guess.clear();
  k_.u_p = s.u;
  k_.p.assign(k_.mesh.cells.n_local(), 0.0);
  k_.p_boundary.assign(s.w.size(), 0.0);
  projection_.equation().set(k_.pressure_placement());
  k_.assembled = s.placement;
  if (k_.sound > 0 && k_.parameters.initial_pressure) return keep_initial(s);
  const Vectors<D> jump_from = s.u_boundary;
  projection_.set_boundary_flux(s.w);
  projection_.solve_initial(at);
  for (const Index b : k_.boundary.rows().of_flux) {
    const Index f = k_.mesh.n_interior + b;
    k_.p_boundary[b] = k_.p[k_.mesh.owner[f]] - (s.w[b] - jump_from[b]).dot(at.area[f]) / at.conductance[f];
  }
  correct();
  s.phi.swap(k_.phi_p);
  s.u.swap(k_.right_side);
  s.w = k_.w;
  s.u_old.clear();
  s.pressure = {};
  k_.boundary.close(k_.mesh, at, s.u, s.w, s.u_boundary);
  flux_.remember(s);
}

/// A compressible fluid may start from any velocity.
template <int D>
void FractionalStep<D>::keep_initial(State<D>& s) {
  for (const Index b : k_.boundary.rows().of_flux) {
    const Index f = k_.mesh.n_interior + b;
    k_.phi_p[f] = s.w[b].dot(s.placement->area[f]);
  }
  s.phi.swap(k_.phi_p);
  k_.phi_p.assign(s.phi.size(), 0.0);
  projection_.solve_initial(*s.placement);  // of nothing: the solver is there, as after any other start
  s.pressure = {};
  k_.boundary.close(k_.mesh, *s.placement, s.u, s.w, s.u_boundary);
  flux_.remember(s);
}

template class FractionalStep<2>;
template class FractionalStep<3>;

}  // namespace couplet::fluid
