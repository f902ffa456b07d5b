// SPDX-License-Identifier: Apache-2.0
#include "solid_solver/solid.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "common/base/error.hpp"
#include "common/parallel/collective.hpp"
#include "solid_solver/mesh_checks.hpp"
#include "solid_solver/output.hpp"
#include "solid_solver/rigid_modes.hpp"
#include "solid_solver/solution_method.hpp"
#include "solid_solver/system.hpp"

namespace couplet {

namespace {

/// Of the gradients without an energy: beyond it they only lock.
constexpr double most_poissons_ratio = 0.499;

/// A support's face has a vertex that is free in a direction which the face knows.
bool has_loose_vertex(const Mesh& mesh, const ElasticOperator& elastic) {
  for (const Index f : elastic.known_faces()) {
    if (elastic.condition(f) != ElasticCondition::support) continue;
    const Tensor3& known = elastic.support(f).known;
    for (const Index v : mesh.face_points[f])
      if ((known * elastic.constraints().free_part(v) * known).trace() > 0.5) return true;
  }
  return false;
}

}  // namespace

Solid::Solid(Mesh mesh, SolidParameters parameters, SolidContext context)
    : mesh_(std::move(mesh)),
      parameters_(std::move(parameters)),
      context_(std::move(context)),
      materials_(materials_of(parameters_)),
      boundaries_(mesh_, parameters_),
      elastic_(mesh_, boundaries_.elastic(), elastic_body(parameters_, mesh_)),
      kernel_(mesh_, elastic_, face_gradient_scheme(parameters_)),
      prescribed_(mesh_, boundaries_, elastic_) {
  check_supports();
  if (has_finite_strain(parameters_)) finite_ = std::make_unique<FiniteStrain>(mesh_, elastic_, parameters_);
  find_mass();
  if (!boundaries_.interface_patches().empty()) {
    interface_ = std::make_unique<InterfaceMap>(mesh_, boundaries_.interface_patches());
    description_ = interface_->describe();
  }
  description_.dim = mesh_.dim;
  description_.takes = taken(parameters_.interface_data.value_or(InterfaceData{}));
  description_.gives = {{"displacement", "m", Interface::Place::vertices},
                        {"velocity", "m/s", Interface::Place::vertices}};
  if (!parameters_.body_force.empty())
    body_force_ = make_expressions(parameters_.body_force, mesh_.dim, "body-force");
  effects_ = make_effects(mesh_, elastic_, parameters_);
  if (parameters_.interface_data && parameters_.interface_data->temperature) {
    if (!interface_)
      throw Error("interface: no patch has 'type: interface', where a temperature could be taken.");
    interface_temperature_ = std::make_unique<InterfaceTemperature>(mesh_.comm, description_.face_centres);
    for (const auto& effect : effects_)
      if (effect->wants_temperature()) effect->set_interface(*interface_temperature_);
  }
  apply_stiffness();
  start_from_rest();
  output_ = std::make_unique<SolidOutput>(*this, context_);
}

Solid::~Solid() = default;

void Solid::check_supports() const {
  check_mesh(mesh_, elastic_.vertices());
  check_symmetry(parameters_, mesh_, elastic_);
  if (!parameters_.gravity.empty() && std::ssize(parameters_.gravity) != mesh_.dim)
    throw Error("gravity: {} components are given where the {}-dimensional scene needs {}.",
                parameters_.gravity.size(), mesh_.dim, mesh_.dim);
  if (!is_dynamic()) check_supported(mesh_, elastic_);
}

void Solid::find_mass() {
  bool has_no_energy = false;
  for (Index f = mesh_.n_interior; f < mesh_.n_flux_faces(); ++f)
    has_no_energy = has_no_energy || elastic_.condition(f) == ElasticCondition::zero_gradient;
  if (kernel_.is_symmetric() && any(mesh_.comm, has_no_energy))
    throw Error(
        "solution-method.face-gradient: symmetric: a boundary of 'type: zero-normal-gradient' has no "
        "energy, so that "
        "this gradient cannot have it; use 'symmetry' or 'frictionless', or 'face-gradient: corrected'.");
  if (kernel_.is_symmetric() && any(mesh_.comm, has_loose_vertex(mesh_, elastic_)))
    throw Error(
        "solution-method.face-gradient: symmetric: a part of a patch holds components of the displacement and ends "
        "at vertices that it does not hold; there this gradient would lose a part of the reaction. Give the part a "
        "patch of its own, hold all components, or take 'face-gradient: corrected'.");
  if (!kernel_.is_symmetric() && largest_poissons_ratio(parameters_) > most_poissons_ratio)
    throw Error(
        "material.poissons-ratio: {:g} is beyond {:g}, up to which 'face-gradient: thesis' and 'corrected' "
        "can go; "
        "'symmetric' can (with 'solution-method: {{type: auto}}' and no 'zero-normal-gradient').",
        largest_poissons_ratio(parameters_), most_poissons_ratio);
  if (!is_dynamic()) return;
  std::vector<double> densities;
  for (Index c = 0; c < mesh_.cells.n_local(); ++c) densities.push_back(density(c));
  has_mass_ = kernel_.set_density(densities);
  if (finite_) finite_->set_density(densities);
}

void Solid::start_from_rest() {
  const int dim = mesh_.dim;
  state_.cell_u.assign(std::size_t(mesh_.cells.n_local()) * dim, 0);
  state_.cell_v = state_.cell_u;
  state_.face_u.assign(std::size_t(mesh_.boundary.n_local()) * dim, 0);
  state_.face_v = state_.offset = state_.offset_rate = state_.face_u;
  known_.assign(prescribed_.size() * dim, 0);
  known_rate_ = known_accepted_ = known_rate_accepted_ = known_;
  rhs_.assign(elastic_.n_unknowns(), 0);
  unknowns_ = rhs_;
  if (is_dynamic() && uses_acceleration(parameters_.time_scheme.type)) state_.cell_a = state_.cell_u;
  if (is_dynamic() && (uses_old_level(parameters_.time_scheme.type) ||
                       parameters_.method.predictor == MethodParameters::Predictor::adams))
    state_.cell_u_old = state_.cell_v_old = state_.cell_u;
  if (has_mass_ && !state_.cell_a.empty()) state_.face_a = state_.face_u;
  if (has_mass_ && !state_.cell_u_old.empty()) state_.face_u_old = state_.face_v_old = state_.face_u;
  if (wants_acceleration()) {
    state_.acceleration = state_.mean_acceleration = state_.cell_u;
    state_.face_acceleration = state_.face_u;
  }
  if (!parameters_.initial_velocity.empty()) {
    const auto velocity = make_expressions(parameters_.initial_velocity, dim, "initial-velocity");
    const std::span<const Vec3> faces(mesh_.reference.face_centre.data() + mesh_.n_interior,
                                      mesh_.boundary.n_local());
    for (int c = 0; c < dim; ++c) {
      velocity[c].evaluate(mesh_.reference.cell_centre, 0, state_.cell_v, dim, c);
      velocity[c].evaluate(faces, 0, state_.face_v, dim, c);
    }
  }
  state_.energies.kinetic = state_.energies.initial_kinetic = kinetic_energy(state_, known_rate_);
  trial_ = state_;
}

Interface Solid::initialise() { return description_; }

// All that was made for the old constants goes.
void Solid::apply_stiffness() {
  for (const auto& effect : effects_) {
    const auto lame = effect->stiffness();
    if (lame.empty()) continue;
    systems_.clear();
    elastic_.set_lame({lame.begin(), lame.end()});
    kernel_ = ElasticKernel(mesh_, elastic_, kernel_.scheme());
    find_mass();
  }
}

void Solid::begin_step(const Step& step) {
  step_ = step;
  effort_ = {};
  if (!(step.dt > 0)) throw Error("The solid was asked for a step of {} s; time must go on.", step.dt);
  if (!interface_temperature_) prepare_stages();
  if (parameters_.output.spectrum && is_dynamic() && step.number == 0) output_->write_spectrum(step.dt);
  if (parameters_.output.modes > 0 && step.number == 0) output_->write_modes();
  if (prescribed_.is_zero()) return;
  const double end = step.time + step.dt;
  prescribed_.evaluate(end, known_);
  if (is_dynamic()) {
    prescribed_.evaluate_rate(end, step.dt, known_rate_);
  } else {
    for (std::size_t i = 0; i < known_.size(); ++i)
      known_rate_[i] = (known_[i] - known_accepted_[i]) / step.dt;
  }
}

void Solid::prepare_stages() {
  const std::vector<Stage> stages = stages_of(step_.dt);
  stages_.resize(stages.size());
  for (const auto& effect : effects_) effect->begin_step(step_);
  apply_stiffness();
  for (std::size_t i = 0; i < stages.size(); ++i) {
    stages_[i].stage = stages[i];
    prepare_stage(stages_[i]);
  }
}

/// The temperature comes with the load, so the loads it makes are prepared here and not when the step begins.
void Solid::take_temperature(const Exchange& in) {
  const auto found = in.find("temperature");
  const std::vector<double> faces =
      interface_temperature_->everywhere(found == in.end() ? std::vector<double>{} : found->second);
  if (!faces.empty() && faces.size() != interface_temperature_->n_faces())
    throw Error("The solid was given {} temperatures; its interface has {} faces.", faces.size(),
                interface_temperature_->n_faces());
  for (const auto& effect : effects_)
    if (effect->wants_temperature()) effect->take_temperature(faces);
  prepare_stages();
}

Exchange Solid::solve(const Exchange& in) {
  if (interface_temperature_) take_temperature(in);
  const std::vector<double> load = interface_load(in);
  if (kernel_.is_symmetric()) last_interface_load_ = load;
  try {
    for (std::size_t i = 0; i < stages_.size(); ++i) solve_stage(stages_[i], load, i == 0);
  } catch (const SolveFailure& failure) {
    // Linear equations: a shorter step meets the same ones.
    if (is_dynamic() || finite_ || step_.scheme != Scheme::standalone) throw;
    throw SchemeFailure("The static step could not be solved, and a shorter one meets the same equations: {}",
                        failure.what());
  }
  trial_.time = step_.time + step_.dt;
  trial_.dt = step_.dt;
  trial_.steps = state_.steps + 1;
  if (!state_.cell_u_old.empty()) {
    trial_.cell_u_old = state_.cell_u;
    trial_.cell_v_old = state_.cell_v;
    if (has_mass_) trial_.face_u_old = state_.face_u, trial_.face_v_old = state_.face_v;
  }
  if (!trial_.acceleration.empty()) finish_acceleration();
  elastic_.impose_known(known_, trial_.face_u);
  elastic_.impose_known(known_rate_, trial_.face_v);
  update_trial_ghosts();
  if (parameters_.step_control) judge_step();
  return interface_values();
}

void Solid::update_trial_ghosts() {
  mesh_.cells.update_ghosts(trial_.cell_u, mesh_.dim);
  mesh_.cells.update_ghosts(trial_.cell_v, mesh_.dim);
  mesh_.boundary.update_ghosts(trial_.face_u, mesh_.dim);
  mesh_.boundary.update_ghosts(trial_.face_v, mesh_.dim);
  elastic_.join_twins(trial_.face_u);
  elastic_.join_twins(trial_.face_v);
}

ResidualProjection* Solid::projection_of(const System& system) {
  return system.method ? system.method->projection() : nullptr;
}

StepReport Solid::accept_step() {
  if (!is_dynamic()) judge_inertia();
  for (const auto& effect : effects_) effect->accept_step();
  for (const StageWork& work : stages_)
    if (ResidualProjection* projection = projection_of(*work.system)) projection->accept();
  std::swap(state_, trial_);
  std::swap(known_accepted_, known_);
  std::swap(known_rate_accepted_, known_rate_);
  // What is written next needs room; a dynamic run may be continued from it, with the same first guesses.
  if (step_.is_last && !is_dynamic()) systems_.clear();
  if (!is_dynamic()) audit_answer();
  for (const auto& effect : effects_)
    if (effect->wants_stress()) effect->take_stress(cell_stress(point_displacement()));
  return {.dt = step_.dt, .iterations = effort_.iterations};
}

}  // namespace couplet
