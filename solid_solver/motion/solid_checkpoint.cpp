// SPDX-License-Identifier: Apache-2.0
// State of a solid and data for its next first guesses in a file.
#include <fmt/format.h>

#include <array>
#include <type_traits>

#include "common/base/error.hpp"
#include "common/elasticity/node_fields.hpp"
#include "common/io/checkpoint.hpp"
#include "common/parallel/collective.hpp"
#include "solid_solver/equilibrium/load_path.hpp"
#include "solid_solver/method/newton_krylov.hpp"
#include "solid_solver/motion/solid_stepper.hpp"

namespace couplet::solid {

namespace {

using mesh::Entries;

/// Arrays of a state by their names in the file; those unused by a scheme are empty.
template <class State, class Visit>
void visit_arrays(State& s, bool has_mass, Visit visit) {
  visit(Entries::cells, "cell-displacement", s.cell_u);
  visit(Entries::cells, "cell-velocity", s.cell_v);
  if (!s.cell_a.empty()) visit(Entries::cells, "cell-acceleration", s.cell_a);
  if (!s.interface.empty()) visit(Entries::owned_boundary, "interface-force", s.interface);
  if (has_mass && !s.cell_a.empty()) visit(Entries::boundary, "nodes-face-acceleration", s.face_a);
  if (has_mass && !s.cell_u_old.empty()) {
    visit(Entries::boundary, "old-face-displacement", s.face_u_old);
    visit(Entries::boundary, "old-face-velocity", s.face_v_old);
  }
  if (!s.acceleration.empty()) {
    visit(Entries::cells, "acceleration", s.acceleration);
    visit(Entries::cells, "mean-acceleration", s.mean_acceleration);
    visit(Entries::boundary, "face-acceleration", s.face_acceleration);
  }
  if (!s.cell_u_old.empty()) {
    visit(Entries::cells, "old-cell-displacement", s.cell_u_old);
    visit(Entries::cells, "old-cell-velocity", s.cell_v_old);
  }
  visit(Entries::boundary, "face-displacement", s.face_u);
  visit(Entries::boundary, "face-velocity", s.face_v);
  visit(Entries::boundary, "face-offset", s.offset);
  visit(Entries::boundary, "face-offset-rate", s.offset_rate);
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

void save_known(io::CheckpointWriter& file, const std::string& name, const mesh::Mesh& mesh,
                const elastic::ElasticOperator& rows, std::span<const double> known) {
  const elastic::NodeFields fields = elastic::fields_of_known(mesh, rows, known);
  file.write(Entries::points, name, fields.inner);
  file.write(Entries::owned_boundary, name + "-faces", fields.faces);
}

std::vector<double> load_known(io::CheckpointReader& file, const std::string& name, const mesh::Mesh& mesh,
                               const elastic::ElasticOperator& rows) {
  elastic::NodeFields fields =
      elastic::fields_of_known(mesh, rows, std::vector<double>(rows.n_known() * mesh.dim));
  file.read(Entries::points, name, fields.inner);
  file.read(Entries::owned_boundary, name + "-faces", fields.faces);
  return elastic::known_of_fields(mesh, rows, fields);
}

}  // namespace

void SolidStepper::save_state(io::CheckpointWriter& file) const {
  file.on(mesh_);
  visit_arrays(state_, body_.has_mass(), [&](Entries entries, const char* name, const auto& values) {
    file.write(entries, name, values);
  });
  if (parallel::any(mesh_.comm, !body_.prescribed().is_zero())) {
    save_known(file, "known-displacement", mesh_, body_.elastic(), state_.known);
    save_known(file, "known-rate", mesh_, body_.elastic(), state_.known_rate);
  }
  visit_scalars(state_, parameters_.step_control.has_value(),
                [&](const char* name, const auto& value) { file.write_scalar(name, value); });
  if (parameters_.output.energies) {
    const SolidEnergies& e = state_.energies;
    file.write_sums("energies", std::vector<double>{e.kinetic, e.initial_kinetic, e.internal_work,
                                                    e.external_work, e.damping_loss});
  }
  if (body_.is_dynamic())
    file.write_sums("load-work", std::vector<double>{state_.load_work, state_.energies.initial_kinetic});
  body_.equilibrium().save(file);
}

void SolidStepper::load_state(io::CheckpointReader& file) {
  file.on(mesh_);
  visit_arrays(state_, body_.has_mass(),
               [&](Entries entries, const char* name, auto& values) { file.read(entries, name, values); });
  if (parallel::any(mesh_.comm, !body_.prescribed().is_zero())) {
    state_.known = load_known(file, "known-displacement", mesh_, body_.elastic());
    state_.known_rate = load_known(file, "known-rate", mesh_, body_.elastic());
  }
  visit_scalars(state_, parameters_.step_control.has_value(), [&](const char* name, auto& value) {
    value = static_cast<std::remove_reference_t<decltype(value)>>(file.read_scalar(name));
  });
  if (parameters_.output.energies) {
    std::array<double, 5> e{};
    file.read_sums("energies", e);
    state_.energies = {e[0], e[1], 0, e[2], e[3], e[4]};
  }
  if (body_.is_dynamic()) {
    std::array<double, 2> work{};
    file.read_sums("load-work", work);
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
    const bool is_cured = system->method && system->method->is_cured();
    if (!is_cured && (!projection || projection->is_empty()))
      continue;  // made for a step that was not accepted
    const std::string name = fmt::format("projection-{}", factors.size());
    file.write_scalar(name + "-by-factors", is_cured);
    factors.push_back(system->mass_factor);
    if (is_cured) continue;
    file.write_common(name, projection->products());
    for (std::size_t k = 0; k < projection->vectors().size(); ++k) {
      const elastic::NodeFields fields =
          elastic::fields_of_unknowns(mesh_, body_.elastic(), projection->vectors()[k]);
      file.write(Entries::owned_cells, fmt::format("{}-cells-{}", name, k), fields.inner);
      file.write(Entries::owned_boundary, fmt::format("{}-faces-{}", name, k), fields.faces);
    }
  }
  file.write_scalar("projections", double(factors.size()));
  for (std::size_t i = 0; i < factors.size(); ++i)
    file.write_scalar(fmt::format("projection-{}-mass-factor", i), factors[i]);
}

void SolidStepper::load_guesses(io::CheckpointReader& file) {
  apply_stiffness();
  const std::size_t n = body_.unknowns_of(state_.cell_u, state_.face_u).size();
  for (std::size_t i = file.read_count("projections", 1000); i-- > 0;) {
    const std::string name = fmt::format("projection-{}", i);
    SolidSystem& system = system_for(file.read_scalar(name + "-mass-factor"));
    if (file.read_scalar(name + "-by-factors") != 0) {
      if (system.method) system.method->cure();
      continue;
    }
    linalg::ResidualProjection* projection = system.projection();
    if (!projection) continue;
    const std::vector<double> products = file.read_common(name);
    std::vector<std::vector<double>> vectors(linalg::ResidualProjection::vectors_of(products));
    elastic::NodeFields fields = elastic::fields_of_unknowns(mesh_, body_.elastic(), std::vector<double>(n));
    for (std::size_t k = 0; k < vectors.size(); ++k) {
      file.read(Entries::owned_cells, fmt::format("{}-cells-{}", name, k), fields.inner);
      file.read(Entries::owned_boundary, fmt::format("{}-faces-{}", name, k), fields.faces);
      vectors[k] = elastic::unknowns_of_fields(mesh_, body_.elastic(), fields);
    }
    const SolidProblem problem = problem_of(system);
    projection->set_values(products, std::move(vectors), [&](std::span<const double> x, std::span<double> y) {
      problem.apply(x, y);
      if (problem.rigid) problem.rigid->project(y);  // as the solves that kept them did
    });
  }
}

}  // namespace couplet::solid
