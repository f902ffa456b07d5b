// SPDX-License-Identifier: Apache-2.0
#include "solid_solver/solid.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "common/base/error.hpp"
#include "common/log/timer.hpp"
#include "common/parallel/collective.hpp"
#include "solid_solver/output.hpp"
#include "solid_solver/system.hpp"

namespace couplet {

Solid::Solid(Mesh mesh, SolidParameters parameters, SolidContext context)
    : mesh_(std::move(mesh)),
      parameters_(std::move(parameters)),
      context_(std::move(context)),
      boundaries_(mesh_, parameters_),
      elastic_(mesh_, boundaries_.conditions(), lame_constants(parameters_)),
      prescribed_(mesh_, boundaries_, elastic_) {
  check_supports();
  if (!boundaries_.interface_patches().empty()) {
    interface_ = std::make_unique<InterfaceMap>(mesh_, boundaries_.interface_patches());
    description_ = interface_->describe();
  }
  description_.dim = mesh_.dim;
  description_.takes = {{"pressure-force", "N", Interface::Place::faces},
                        {"viscous-force", "N", Interface::Place::faces}};
  description_.gives = {{"displacement", "m", Interface::Place::vertices},
                        {"velocity", "m/s", Interface::Place::vertices}};
  if (!parameters_.body_force.empty())
    body_force_ = make_expressions(parameters_.body_force, mesh_.dim, "body-force");
  effects_ = make_effects(mesh_, elastic_, parameters_);
  start_from_rest();
  output_ = std::make_unique<SolidOutput>(*this, context_);
}

Solid::~Solid() = default;

void Solid::check_supports() const {
  if (!parameters_.gravity.empty() && std::ssize(parameters_.gravity) != mesh_.dim)
    throw Error("gravity: {} components are given where the {}-dimensional scene needs {}.",
                parameters_.gravity.size(), mesh_.dim, mesh_.dim);
  if (!is_dynamic() && !boundaries_.any_prescribed() && !boundaries_.any_symmetry())
    throw Error(
        "boundaries: a static analysis needs a support, or the solid can move freely; give at least one "
        "patch 'type: "
        "fixed-displacement' (or enough 'symmetry' patches).");
}

void Solid::start_from_rest() {
  const int dim = mesh_.dim;
  state_.cell_u.assign(std::size_t(mesh_.cells.n_local()) * dim, 0);
  state_.cell_v = state_.cell_u;
  state_.face_u.assign(std::size_t(mesh_.boundary.n_local()) * dim, 0);
  state_.face_v = state_.offset = state_.offset_rate = state_.face_u;
  known_.assign(prescribed_.size() * dim, 0);
  known_rate_ = known_accepted_ = known_rate_accepted_ = known_in_stress_ = known_;
  face_force_ = std::vector<double>(std::size_t(mesh_.boundary.n_owned()) * dim, 0);
  base_rhs_.assign(elastic_.n_unknowns(), 0);
  rhs_ = unknowns_ = base_rhs_;
  if (!parameters_.initial_velocity.empty()) {
    const auto velocity = make_expressions(parameters_.initial_velocity, dim, "initial-velocity");
    const std::span<const Vec3> faces(mesh_.reference.face_centre.data() + mesh_.n_interior,
                                      mesh_.boundary.n_local());
    for (int c = 0; c < dim; ++c) {
      velocity[c].evaluate(mesh_.reference.cell_centre, 0, state_.cell_v, dim, c);
      velocity[c].evaluate(faces, 0, state_.face_v, dim, c);
    }
  }
  trial_ = state_;
}

Interface Solid::initialise() { return description_; }

Solid::System& Solid::system_for(double dt) {
  const auto same = [dt](const std::unique_ptr<System>& s) { return std::abs(s->dt - dt) <= 1e-10 * dt; };
  const auto found = std::ranges::find_if(systems_, same);
  if (found != systems_.end()) {
    std::rotate(systems_.begin(), found, found + 1);
  } else {
    if (systems_.size() == 2) systems_.pop_back();
    systems_.insert(systems_.begin(), std::make_unique<System>(mesh_, parameters_, elastic_, dt));
  }
  return *systems_.front();
}

void Solid::begin_step(const Step& step) {
  step_ = step;
  if (!(step.dt > 0)) throw Error("The solid was asked for a step of {} s; time must go on.", step.dt);
  const int dim = mesh_.dim;
  const double load_time = is_dynamic() ? step.time + 0.5 * step.dt : step.time + step.dt;
  const System& system = system_for(is_dynamic() ? step.dt : 0);
  std::ranges::fill(base_rhs_, 0.0);
  if (is_dynamic()) {
    const double rho = parameters_.material.density;
    for (Index c = 0; c < mesh_.cells.n_owned(); ++c)
      for (int a = 0; a < dim; ++a) {
        const std::size_t i = std::size_t(c) * dim + a;
        base_rhs_[i] = system.inertia[c] * state_.cell_u[i] +
                       2 * rho * mesh_.reference.volume[c] / system.dt * state_.cell_v[i];
      }
  }
  add_body_forces(load_time);
  for (const auto& effect : effects_) {
    effect->begin_step(step);
    effect->add_loads(load_time, base_rhs_);
  }
  std::ranges::fill(face_force_, 0.0);
  boundaries_.add_forces(load_time, face_force_);
  prepare_prescribed();
  if (!prescribed_.is_zero()) elastic_.subtract_known(known_in_stress_, base_rhs_);
}

// Stress of a dynamic step: w = mean of the end values + beta times the mean rate (see the class).
void Solid::prepare_prescribed() {
  if (prescribed_.is_zero()) return;
  const double end = step_.time + step_.dt;
  prescribed_.evaluate(end, known_);
  known_in_stress_ = known_;
  if (!is_dynamic()) return;
  prescribed_.evaluate_rate(end, step_.dt, known_rate_);
  std::vector<double> start(known_.size());
  prescribed_.evaluate(step_.time, start);
  const double beta = parameters_.damping ? parameters_.damping->stiffness : 0;
  for (std::size_t i = 0; i < known_.size(); ++i)
    known_in_stress_[i] = 0.5 * (start[i] + known_[i]) + beta / step_.dt * (known_[i] - start[i]);
}

void Solid::add_body_forces(double t) {
  body_load_.setZero();
  if (body_force_.empty() && parameters_.gravity.empty()) return;
  const int dim = mesh_.dim;
  for (Index c = 0; c < mesh_.cells.n_owned(); ++c)
    for (int a = 0; a < dim; ++a) {
      double force = body_force_.empty() ? 0 : body_force_[a](mesh_.reference.cell_centre[c], t);
      if (!parameters_.gravity.empty()) force += parameters_.material.density * parameters_.gravity[a];
      force *= mesh_.reference.volume[c];  // (2.59)
      base_rhs_[std::size_t(c) * dim + a] += force;
      body_load_[a] += force;
    }
}

// The known force of a traction face stands in its own row and in its cell's.
void Solid::add_interface_load(const Exchange& in) {
  const int dim = mesh_.dim;
  std::vector<double> force = face_force_;
  if (interface_) {
    std::vector<double> on_root(comm_rank(mesh_.comm) == 0 ? description_.face_centres.size() * dim : 0, 0.0);
    for (const auto& [name, values] : in) {
      if (name != "pressure-force" && name != "viscous-force")
        throw Error("The solid was given '{}'; it takes 'pressure-force' and 'viscous-force'.", name);
      if (comm_rank(mesh_.comm) != 0) continue;
      if (values.size() != on_root.size())
        throw Error("The solid was given {} values of '{}'; its interface has {} faces of {} components.",
                    values.size(), name, description_.face_centres.size(), dim);
      for (std::size_t i = 0; i < values.size(); ++i) on_root[i] += values[i];
    }
    const std::vector<double> local = interface_->scatter_faces(on_root, dim);
    for (std::size_t i = 0; i < interface_->faces().size(); ++i)
      for (int a = 0; a < dim; ++a)
        force[std::size_t(interface_->faces()[i] - mesh_.n_interior) * dim + a] += local[i * dim + a];
  }
  face_load_.setZero();
  const auto& faces = elastic_.traction_faces();
  const std::size_t first = std::size_t(mesh_.cells.n_owned()) * dim;
  for (std::size_t i = 0; i < faces.size(); ++i)
    for (int a = 0; a < dim; ++a) {
      const double value = force[std::size_t(faces[i] - mesh_.n_interior) * dim + a];
      rhs_[std::size_t(mesh_.owner[faces[i]]) * dim + a] += value;
      rhs_[first + i * dim + a] += value;
      face_load_[a] += value;
    }
}

Exchange Solid::solve(const Exchange& in) {
  System& system = *systems_.front();
  rhs_ = base_rhs_;
  add_interface_load(in);
  const int dim = mesh_.dim;
  const std::size_t n_cells = std::size_t(mesh_.cells.n_owned()) * dim;
  // First guess of iterative methods: the accepted state, so that equal loads give equal answers.
  std::copy_n(state_.cell_u.begin(), n_cells, unknowns_.begin());
  const auto& faces = elastic_.traction_faces();
  for (std::size_t i = 0; i < faces.size(); ++i)
    for (int a = 0; a < dim; ++a)
      unknowns_[n_cells + i * dim + a] = state_.face_u[std::size_t(faces[i] - mesh_.n_interior) * dim + a];
  {
    const log::ScopedTimer timer(log::timers(), "solid: linear solver");
    system.method->solve(rhs_, unknowns_);
  }
  trial_.time = step_.time + step_.dt;
  trial_.dt = step_.dt;
  trial_.steps = state_.steps + 1;
  is_dynamic() ? finish_dynamic(system) : finish_static();
  return interface_values();
}

void Solid::finish_dynamic(const System& system) {
  const int dim = mesh_.dim;
  const double dt = step_.dt, s = system.damping_scale;
  const std::size_t n_cells = std::size_t(mesh_.cells.n_owned()) * dim;
  for (std::size_t i = 0; i < n_cells; ++i) {
    const double half = (unknowns_[i] - state_.cell_u[i]) / s;  // ubar - u^n
    trial_.cell_u[i] = state_.cell_u[i] + 2 * half;
    trial_.cell_v[i] = 4 * half / dt - state_.cell_v[i];
  }
  // delta = u_B - u_P at n+1 from the middles n+1/2 and n-1/2 (equal steps: 3/2 and -1/2), then its rate
  // likewise from (delta^{n+1} - delta^n) / dt, which lives at n+1/2.
  const double slope = state_.steps > 0 ? dt / (dt + state_.dt) : 0;
  const auto& faces = elastic_.traction_faces();
  for (std::size_t i = 0; i < faces.size(); ++i)
    for (int a = 0; a < dim; ++a) {
      const std::size_t b = std::size_t(faces[i] - mesh_.n_interior) * dim + a;
      const std::size_t c = std::size_t(mesh_.owner[faces[i]]) * dim + a;
      const double middle = unknowns_[n_cells + i * dim + a] - unknowns_[c];
      const double end = middle + slope * (middle - state_.offset[b]);
      trial_.offset[b] = middle;
      trial_.face_u[b] = trial_.cell_u[c] + end;
      const double rate = (end - (state_.face_u[b] - state_.cell_u[c])) / dt;
      trial_.offset_rate[b] = rate;
      trial_.face_v[b] = trial_.cell_v[c] + rate + slope * (rate - state_.offset_rate[b]);
    }
  set_prescribed_faces();
  update_trial_ghosts();
}

void Solid::finish_static() {
  const int dim = mesh_.dim;
  const std::size_t n_cells = std::size_t(mesh_.cells.n_owned()) * dim;
  for (std::size_t i = 0; i < n_cells; ++i) {
    trial_.cell_u[i] = unknowns_[i];
    trial_.cell_v[i] = (unknowns_[i] - state_.cell_u[i]) / step_.dt;
  }
  const auto& faces = elastic_.traction_faces();
  for (std::size_t i = 0; i < faces.size(); ++i)
    for (int a = 0; a < dim; ++a) {
      const std::size_t b = std::size_t(faces[i] - mesh_.n_interior) * dim + a;
      trial_.face_u[b] = unknowns_[n_cells + i * dim + a];
      trial_.face_v[b] = (trial_.face_u[b] - state_.face_u[b]) / step_.dt;
    }
  for (std::size_t i = 0; i < known_.size(); ++i)
    known_rate_[i] = (known_[i] - known_accepted_[i]) / step_.dt;
  set_prescribed_faces();
  update_trial_ghosts();
}

void Solid::set_prescribed_faces() {
  const int dim = mesh_.dim;
  for (const Index f : elastic_.prescribed_faces())
    for (int a = 0; a < dim; ++a) {
      const std::size_t b = std::size_t(f - mesh_.n_interior) * dim + a;
      const std::size_t k = std::size_t(elastic_.known_of_face(f)) * dim + a;
      trial_.face_u[b] = known_[k];
      trial_.face_v[b] = known_rate_[k];
    }
}

void Solid::update_trial_ghosts() {
  mesh_.cells.update_ghosts(trial_.cell_u, mesh_.dim);
  mesh_.cells.update_ghosts(trial_.cell_v, mesh_.dim);
  mesh_.boundary.update_ghosts(trial_.face_u, mesh_.dim);
  mesh_.boundary.update_ghosts(trial_.face_v, mesh_.dim);
}

void Solid::accept_step() {
  if (!is_dynamic()) judge_inertia();
  for (const auto& effect : effects_) effect->accept_step();
  std::swap(state_, trial_);
  std::swap(known_accepted_, known_);
  std::swap(known_rate_accepted_, known_rate_);
}

}  // namespace couplet
