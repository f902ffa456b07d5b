// SPDX-License-Identifier: Apache-2.0
// The state of a solid and what its next first guesses learn from, on file.
#include <fmt/format.h>

#include <array>
#include <type_traits>

#include "common/base/error.hpp"
#include "common/io/checkpoint.hpp"
#include "common/io/numbering.hpp"
#include "solid_solver/large_strain/load_path.hpp"
#include "solid_solver/method/newton_krylov.hpp"
#include "solid_solver/motion/solid_stepper.hpp"

namespace couplet::solid {

namespace {

/// The arrays of a state by their names on file; those that a scheme does not have are empty in a fresh state, too.
template <class State, class Visit>
void visit_arrays(State& s, bool has_mass, Visit visit) {
  visit("cell-displacement", s.cell_u);
  visit("cell-velocity", s.cell_v);
  if (!s.cell_a.empty()) visit("cell-acceleration", s.cell_a);
  if (has_mass && !s.cell_a.empty()) visit("nodes-face-acceleration", s.face_a);
  if (has_mass && !s.cell_u_old.empty()) {
    visit("old-face-displacement", s.face_u_old);
    visit("old-face-velocity", s.face_v_old);
  }
  if (!s.acceleration.empty()) {
    visit("acceleration", s.acceleration);
    visit("mean-acceleration", s.mean_acceleration);
    visit("face-acceleration", s.face_acceleration);
  }
  if (!s.cell_u_old.empty()) {
    visit("old-cell-displacement", s.cell_u_old);
    visit("old-cell-velocity", s.cell_v_old);
  }
  visit("face-displacement", s.face_u);
  visit("face-velocity", s.face_v);
  visit("face-offset", s.offset);
  visit("face-offset-rate", s.offset_rate);
  visit("known-displacement", s.known);
  visit("known-rate", s.known_rate);
}

template <class State, class Visit>
void visit_scalars(State& s, bool controls_step, Visit visit) {
  visit("time", s.time);
  if (controls_step) visit("error", s.error);
  visit("dt", s.dt);
  visit("stage-dt", s.stage_dt);
  visit("offset-lag", s.offset_lag);
  visit("steps", s.steps);
}

}  // namespace

void SolidStepper::save_state(io::CheckpointWriter& file) const {
  io::write_numbering(file, mesh_);
  visit_arrays(state_, body_.has_mass(),
               [&](const char* name, const auto& values) { file.write(name, values); });
  visit_scalars(state_, parameters_.step_control.has_value(),
                [&](const char* name, const auto& value) { file.write_scalar(name, value); });
  if (parameters_.output.energies) {
    const SolidEnergies& e = state_.energies;
    file.write("energies", std::vector<double>{e.kinetic, e.initial_kinetic, e.internal_work, e.external_work,
                                               e.damping_loss});
  }
  if (body_.is_dynamic())
    file.write("load-work", std::vector<double>{state_.load_work, state_.energies.initial_kinetic});
  body_.equilibrium().save(file);
}

void SolidStepper::load_state(io::CheckpointReader& file) {
  io::check_numbering(file, mesh_);
  visit_arrays(state_, body_.has_mass(), [&](const char* name, auto& values) { file.read(name, values); });
  visit_scalars(state_, parameters_.step_control.has_value(), [&](const char* name, auto& value) {
    value = static_cast<std::remove_reference_t<decltype(value)>>(file.read_scalar(name));
  });
  if (parameters_.output.energies) {
    std::array<double, 5> e{};
    file.read("energies", e);
    state_.energies = {e[0], e[1], 0, e[2], e[3], e[4]};
  }
  if (body_.is_dynamic()) {
    std::array<double, 2> work{};
    file.read("load-work", work);
    state_.load_work = work[0];
    state_.energies.initial_kinetic = work[1];
  }
  body_.equilibrium().load(file, body_.unknowns_of(state_.cell_u, state_.face_u), state_.known);
  if (const LoadPath* path = body_.equilibrium().load_path()) body_.set_load_factor(path->factor());
}

void SolidStepper::save_guesses(io::CheckpointWriter& file) const {
  std::vector<double> factors;
  for (const auto& system : systems_) {
    const linalg::ResidualProjection* projection = system->projection();
    if (!projection || projection->is_empty()) continue;  // made for a step that was not accepted
    file.write(fmt::format("projection-{}", factors.size()), projection->values());
    factors.push_back(system->mass_factor);
  }
  file.write_scalar("projections", double(factors.size()));
  for (std::size_t i = 0; i < factors.size(); ++i)
    file.write_scalar(fmt::format("projection-{}-mass-factor", i), factors[i]);
}

void SolidStepper::load_guesses(io::CheckpointReader& file) {
  apply_stiffness();
  for (std::size_t i = file.read_count("projections", 1000); i-- > 0;) {
    SolidSystem& system = system_for(file.read_scalar(fmt::format("projection-{}-mass-factor", i)));
    const SolidProblem problem = problem_of(system);
    const auto apply = [&](std::span<const double> x, std::span<double> y) {
      if (x.size() != body_.unknowns_of(state_.cell_u, state_.face_u).size())
        throw Error("The checkpoint's solver corrections are from another mesh. Use an earlier checkpoint.");
      problem.apply(x, y);
      if (problem.rigid) problem.rigid->project(y);  // as the solves that kept them did
    };
    if (linalg::ResidualProjection* projection = system.projection())
      projection->set_values(file.read(fmt::format("projection-{}", i)), apply);
  }
}

}  // namespace couplet::solid
