// SPDX-License-Identifier: Apache-2.0
// State of a solid and data for its next first guesses in a file.
#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "common/elasticity/node_fields.hpp"
#include "common/io/checkpoint.hpp"
#include "common/parallel/collective.hpp"
#include "solid_solver/equilibrium/load_path.hpp"
#include "solid_solver/method/conjugate_gradients.hpp"
#include "solid_solver/motion/solid_stepper.hpp"

namespace couplet::solid {

using mesh::Entries;

void SolidStepper::visit(io::Archive& archive) {
  SolidState& s = state_;
  SolidEnergies& e = s.energies;
  // Fields that the case does not use are empty on all ranks.
  const auto field = [&](Entries entries, const char* name, std::vector<double>& values) {
    if (parallel::any(mesh_.comm, !values.empty()))
      archive.field(entries, name, values, std::size_t(mesh_.dim));
  };
  field(Entries::cells, "cell-displacement", s.cell_u);
  field(Entries::cells, "cell-velocity", s.cell_v);
  field(Entries::cells, "cell-acceleration", s.cell_a);
  field(Entries::cells, "old-cell-displacement", s.cell_u_old);
  field(Entries::cells, "old-cell-velocity", s.cell_v_old);
  field(Entries::boundary, "face-displacement", s.face_u);
  field(Entries::boundary, "face-velocity", s.face_v);
  field(Entries::boundary, "nodes-face-acceleration", s.face_a);
  field(Entries::boundary, "old-face-displacement", s.face_u_old);
  field(Entries::boundary, "old-face-velocity", s.face_v_old);
  field(Entries::boundary, "face-offset", s.offset);
  field(Entries::boundary, "face-offset-rate", s.offset_rate);
  field(Entries::owned_boundary, "interface-force", s.interface);
  field(Entries::cells, "acceleration", s.acceleration);
  field(Entries::cells, "mean-acceleration", s.mean_acceleration);
  field(Entries::boundary, "face-acceleration", s.face_acceleration);
  if (parallel::any(mesh_.comm, !body_.prescribed().is_zero())) {
    elastic::visit_known(archive, "known-displacement", mesh_, body_.elastic(), s.known);
    elastic::visit_known(archive, "known-rate", mesh_, body_.elastic(), s.known_rate);
  }
  archive.common("state", s.time, s.dt, s.stage_dt, s.offset_lag, s.steps, s.error);
  const std::array parts{&e.kinetic,       &e.initial_kinetic, &e.internal_work,
                         &e.external_work, &e.damping_loss,    &s.load_work};
  std::vector<double> sums;
  for (const double* part : parts) sums.push_back(*part);
  archive.sums("energies", sums);
  for (std::size_t i = 0; i < sums.size(); ++i) *parts[i] = sums[i];
  if (LargeStrain* large = body_.large_strain())
    large->visit(archive, body_.unknowns_of(s.cell_u, s.face_u), s.known);
  if (!archive.reads()) return;
  if (const LoadPath* path = body_.load_path()) body_.set_load_factor(path->factor());
}

namespace {

/// First guesses of one system: those of a projection, or that its factors have replaced the iteration.
struct Guesses {
  double mass_factor = 0;
  bool by_factors = false;
  std::vector<double> products;
  const linalg::ResidualProjection* saved = nullptr;

  template <class Numbers>
  void visit(Numbers& numbers) {
    numbers(mass_factor, by_factors, products);
  }
};

}  // namespace

void SolidStepper::visit_guesses(io::Archive& archive) {
  std::vector<Guesses> all;
  for (std::size_t i = 0; i < systems_.size() && !archive.reads(); ++i) {
    const SolidSystem& system = *systems_[i];
    const linalg::ResidualProjection* projection = system.projection();
    if (system.method && system.method->is_cured())
      all.push_back({system.mass_factor, true, {}});
    else if (projection && !projection->is_empty())  // else made for a step that was not accepted
      all.push_back({system.mass_factor, false, projection->products(), projection});
  }
  archive.common("projections", all);
  if (archive.reads()) apply_stiffness();
  for (std::size_t i = all.size(); i-- > 0;) {
    const Guesses& guesses = all[i];
    const std::size_t n = guesses.by_factors ? 0 : linalg::ResidualProjection::vectors_of(guesses.products);
    std::vector<std::vector<double>> vectors;
    for (std::size_t k = 0; k < n; ++k) {
      std::vector<double> values(elastic_.n_unknowns(), 0);
      if (guesses.saved) std::ranges::copy(guesses.saved->vectors()[k], values.begin());
      elastic::visit_unknowns(archive, fmt::format("projection-{}-{}", i, k), mesh_, elastic_, values);
      if (archive.reads()) vectors.push_back(std::move(values));
    }
    if (!archive.reads()) continue;
    SolidSystem& system = system_for(guesses.mass_factor);
    if (guesses.by_factors && system.method) system.method->cure();
    linalg::ResidualProjection* projection = system.projection();
    if (guesses.by_factors || !projection) continue;
    const SolidProblem problem = problem_of(system);
    projection->set_values(guesses.products, std::move(vectors),
                           [&](std::span<const double> x, std::span<double> y) {
                             problem.apply(x, y);
                             if (problem.project) problem.project(y);  // as the solves that kept them did
                           });
  }
}

}  // namespace couplet::solid
