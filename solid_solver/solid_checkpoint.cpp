// SPDX-License-Identifier: Apache-2.0
// The state of a solid and what its next first guesses learn from, on file.
#include <fmt/format.h>

#include "common/io/checkpoint.hpp"
#include "common/io/numbering.hpp"
#include "solid_solver/newton_krylov.hpp"
#include "solid_solver/solid_stepper.hpp"

namespace couplet {

void SolidStepper::save_state(CheckpointWriter& file) const {
  write_numbering(file, mesh_);
  file.write("cell-displacement", state_.cell_u);
  file.write("cell-velocity", state_.cell_v);
  if (!state_.cell_a.empty()) file.write("cell-acceleration", state_.cell_a);
  if (body_.has_mass()) {
    if (!state_.face_a.empty()) file.write("nodes-face-acceleration", state_.face_a);
    if (!state_.face_u_old.empty()) {
      file.write("old-face-displacement", state_.face_u_old);
      file.write("old-face-velocity", state_.face_v_old);
    }
  }
  if (!state_.acceleration.empty()) {
    file.write("acceleration", state_.acceleration);
    file.write("mean-acceleration", state_.mean_acceleration);
    file.write("face-acceleration", state_.face_acceleration);
  }
  if (!state_.cell_u_old.empty()) {
    file.write("old-cell-displacement", state_.cell_u_old);
    file.write("old-cell-velocity", state_.cell_v_old);
  }
  file.write("face-displacement", state_.face_u);
  file.write("face-velocity", state_.face_v);
  file.write("face-offset", state_.offset);
  file.write("face-offset-rate", state_.offset_rate);
  file.write("known-displacement", state_.known);
  file.write("known-rate", state_.known_rate);
  file.write_scalar("time", state_.time);
  if (parameters_.output.energies) {
    const SolidEnergies& e = state_.energies;
    file.write("energies", std::vector<double>{e.kinetic, e.initial_kinetic, e.internal_work, e.external_work,
                                               e.damping_loss});
  }
  if (body_.is_dynamic())
    file.write("load-work", std::vector<double>{state_.load_work, state_.energies.initial_kinetic});
  if (parameters_.step_control) file.write_scalar("error", state_.error);
  file.write_scalar("dt", state_.dt);
  file.write_scalar("stage-dt", state_.stage_dt);
  file.write_scalar("offset-lag", state_.offset_lag);
  file.write_scalar("steps", state_.steps);
}

void SolidStepper::load_state(CheckpointReader& file) {
  check_numbering(file, mesh_);
  file.read("cell-displacement", state_.cell_u);
  file.read("cell-velocity", state_.cell_v);
  if (!state_.cell_a.empty()) file.read("cell-acceleration", state_.cell_a);
  if (body_.has_mass()) {
    if (!state_.face_a.empty()) file.read("nodes-face-acceleration", state_.face_a);
    if (!state_.face_u_old.empty()) {
      file.read("old-face-displacement", state_.face_u_old);
      file.read("old-face-velocity", state_.face_v_old);
    }
  }
  if (!state_.acceleration.empty()) {
    file.read("acceleration", state_.acceleration);
    file.read("mean-acceleration", state_.mean_acceleration);
    file.read("face-acceleration", state_.face_acceleration);
  }
  if (!state_.cell_u_old.empty()) {
    file.read("old-cell-displacement", state_.cell_u_old);
    file.read("old-cell-velocity", state_.cell_v_old);
  }
  file.read("face-displacement", state_.face_u);
  file.read("face-velocity", state_.face_v);
  file.read("face-offset", state_.offset);
  file.read("face-offset-rate", state_.offset_rate);
  file.read("known-displacement", state_.known);
  file.read("known-rate", state_.known_rate);
  state_.time = file.read_scalar("time");
  if (parameters_.output.energies) {
    const std::vector<double> e = file.read("energies");
    state_.energies = {e.at(0), e.at(1), 0, e.at(2), e.at(3), e.at(4)};
  }
  if (body_.is_dynamic()) {
    const std::vector<double> work = file.read("load-work");
    state_.load_work = work.at(0);
    state_.energies.initial_kinetic = work.at(1);
  }
  if (parameters_.step_control) state_.error = file.read_scalar("error");
  state_.dt = file.read_scalar("dt");
  state_.stage_dt = file.read_scalar("stage-dt");
  state_.offset_lag = file.read_scalar("offset-lag");
  state_.steps = static_cast<int>(file.read_scalar("steps"));
}

void SolidStepper::save_guesses(CheckpointWriter& file) const {
  std::vector<double> factors;
  for (const auto& system : systems_) {
    const ResidualProjection* projection = system->projection();
    if (!projection) continue;
    file.write(fmt::format("projection-{}", factors.size()), projection->values());
    factors.push_back(system->mass_factor);
  }
  file.write_scalar("projections", double(factors.size()));
  for (std::size_t i = 0; i < factors.size(); ++i)
    file.write_scalar(fmt::format("projection-{}-mass-factor", i), factors[i]);
}

void SolidStepper::load_guesses(CheckpointReader& file) {
  apply_stiffness();
  for (int i = static_cast<int>(file.read_scalar("projections")); i-- > 0;) {
    SolidSystem& system = system_for(file.read_scalar(fmt::format("projection-{}-mass-factor", i)));
    const SolidProblem problem = problem_of(system);
    const auto apply = [&](std::span<const double> x, std::span<double> y) { problem.apply(x, y); };
    if (ResidualProjection* projection = system.projection())
      projection->set_values(file.read(fmt::format("projection-{}", i)), apply);
  }
}

}  // namespace couplet
