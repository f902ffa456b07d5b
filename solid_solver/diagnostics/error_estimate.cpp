// SPDX-License-Identifier: Apache-2.0
#include "solid_solver/diagnostics/error_estimate.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <optional>

#include "common/base/error.hpp"
#include "common/base/numbers.hpp"
#include "common/elasticity/symmetric/symmetric_faces.hpp"
#include "common/io/checkpoint.hpp"
#include "common/parallel/collective.hpp"
#include "solid_solver/diagnostics/inner_variation.hpp"
#include "solid_solver/diagnostics/soft_motion.hpp"
#include "solid_solver/diagnostics/weighted_estimate.hpp"

namespace couplet::solid {

SolidErrorEstimate::SolidErrorEstimate(const SolidBody& body, const SolidStepper& stepper,
                                       const SolidFields& fields, const SolidJudge& judge)
    : body_(body), stepper_(stepper), fields_(fields), judge_(judge), steps_(scheme_of(body.parameters())) {
  const mesh::Geometry& geometry = body.geometry();
  const mesh::Mesh& mesh = body.mesh();
  for (Index c = 0; c < mesh.cells.n_owned(); ++c) volume_ += geometry.volume[c];
  volume_ = parallel::sum(mesh.comm, volume_);
}

/// Over the volume; `dim` values a cell.
double SolidErrorEstimate::mean_square(std::span<const double> cells) const {
  const mesh::Mesh& mesh = body_.mesh();
  const mesh::Geometry& geometry = body_.geometry();
  double squares = 0;
  for (Index c = 0; c < mesh.cells.n_owned(); ++c)
    for (int a = 0; a < mesh.dim; ++a) {
      const double value = cells[std::size_t(c) * mesh.dim + a];
      squares += geometry.volume[c] * value * value;
    }
  return parallel::sum(mesh.comm, squares) / volume_;
}

/// Over the size of the solution.
double SolidErrorEstimate::left_by_solver() const {
  const LastSolve& last = stepper_.last_solve();
  return body_.equilibrium().share_left(stepper_.effort().residual, norm(body_.mesh().comm, last.rhs));
}

/// |u . (b - A u)| / |u . b| of the last static solve, linear: u . b grows by as much as A u misses of b.
double SolidErrorEstimate::missed_work() const {
  const LastSolve& last = stepper_.last_solve();
  if (!last.is_known(body_.mesh().comm)) return 0;
  std::vector<double> force(last.unknowns.size());
  body_.kernel().apply(last.unknowns, {}, force);
  double missed = 0, work = 0;
  for (std::size_t i = 0; i < force.size(); ++i) {
    missed += last.unknowns[i] * (last.rhs[i] - force[i]);
    work += last.unknowns[i] * last.rhs[i];
  }
  const MPI_Comm comm = body_.mesh().comm;
  missed = parallel::sum(comm, missed), work = parallel::sum(comm, work);
  return work != 0 ? std::abs(missed / work) : 0;
}

/// What effects load the solid with errs, too: the displacement that follows from it by as much, |u . b_effect| / u . K u of the whole.
void SolidErrorEstimate::add_loads(diagnostics::ErrorParts& parts) const {
  const MPI_Comm comm = body_.mesh().comm;
  const SolidState& state = stepper_.state();
  const std::vector<double> u = body_.unknowns_of(state.cell_u, state.face_u);
  std::vector<double> force(u.size());
  body_.kernel().apply(u, {}, force);
  const double energy = parallel::sum(comm, std::inner_product(u.begin(), u.end(), force.begin(), 0.0));
  for (const auto& effect : body_.effects()) {
    const diagnostics::ErrorParts load = effect->error_parts();
    if (!load.known()) continue;
    std::vector<double> forces(u.size(), 0.0);
    effect->add_loads(state.time, body_.kernel(), forces);
    const double work = parallel::sum(comm, std::inner_product(u.begin(), u.end(), forces.begin(), 0.0));
    const double share = energy > 0 ? std::min(1.0, std::abs(work) / energy) : 1;
    for (const auto part : {&diagnostics::ErrorParts::mesh, &diagnostics::ErrorParts::step})
      parts.*part = std::fmax(parts.*part, share * load.*part);  // fmax: a number beats NaN
  }
}

/// Share of the strain energy that the mesh misses: half of sum V mu |E1 - E2|^2 / sum V mu |E1|^2 of the Green strains
/// E = (H + H^T + H^T H) / 2 of the gradient in use and the corrected one, which turning the body leaves as they are, half
/// since each gradient errs; or, if more, what quadrilaterals miss, by the law's moduli at rest.
double SolidErrorEstimate::missed_of_large_strain(const SolidState& state,
                                                  std::span<const double> unknowns) const {
  const mesh::Mesh& mesh = body_.mesh();
  const mesh::Geometry& geometry = body_.geometry();
  const elastic::ElasticOperator& rows = body_.elastic();
  const std::vector<double> known =
      body_.known_of({state.cell_u, state.face_u, fields_.point_displacement()});
  const auto strain = [](const Tensor3& h) { return Tensor3(0.5 * (h + h.transpose() + h.transpose() * h)); };
  const auto weight = [&](Index f) {
    if (mesh.owner[f] >= mesh.cells.n_owned()) return 0.0;
    const auto [here, there] = elastic::pyramids(mesh, geometry, f);
    return (here + there) * rows.lame(mesh.owner[f]).mu;
  };
  std::optional<InnerVariation> inner;
  if (InnerVariation::is_needed(mesh, rows)) inner.emplace(mesh, rows);
  std::vector<Tensor3> used(std::size_t(mesh.n_flux_faces()));
  double difference = 0, size = 0;
  body_.kernel().face_gradients(
      unknowns, known,
      [&](Index f, const Tensor3& gradient) {
        const Tensor3 e = used[std::size_t(f)] = strain(gradient);
        size += weight(f) * e.squaredNorm();
        if (inner) inner->add(f, e);
      },
      0, mesh.n_flux_faces());
  elastic::ElasticKernel(mesh, rows, elastic::FaceGradientScheme::corrected)
      .face_gradients(
          unknowns, known,
          [&](Index f, const Tensor3& gradient) {
            difference += weight(f) * (strain(gradient) - used[std::size_t(f)]).squaredNorm();
          },
          0, mesh.n_flux_faces());
  size = parallel::sum(mesh.comm, size), difference = parallel::sum(mesh.comm, difference);
  return std::max(size > 0 ? 0.5 * difference / size : 0, inner ? inner->missed() : 0);
}

/// The displacement follows as softly as the deformed body does. NaN: its tangent has no solution.
double SolidErrorEstimate::finite_mesh_error() const {
  const SolidState& state = stepper_.state();
  const std::vector<double> unknowns = body_.unknowns_of(state.cell_u, state.face_u);
  const double energy = missed_of_large_strain(state, unknowns);
  if (body_.is_dynamic()) return energy;
  try {
    const std::vector<double> known =
        body_.known_of({state.cell_u, state.face_u, fields_.point_displacement()});
    return std::max(energy * body_.equilibrium().softness(unknowns, state.known),
                    soft_mesh_error(body_, unknowns, known, judge_.softest()));
  } catch (const SolveFailure&) {
    return diagnostics::ErrorParts::unknown;
  }
}

/// At least `known`. Energies are no measure of it where heat strains the body; one in motion need not be held, so that nothing is known.
double SolidErrorEstimate::thermal_mesh_error(double known) const {
  if (body_.is_dynamic() || is_axisymmetric(body_.elastic())) return diagnostics::ErrorParts::unknown;
  const SolidState& state = stepper_.state();
  std::vector<double> pressure(std::size_t(body_.mesh().n_faces()), 0);
  for (const auto& effect : body_.effects()) {
    const std::vector<double> one = effect->pressure(state.time);
    for (std::size_t f = 0; f < one.size(); ++f) pressure[f] += one[f];
  }
  const double weighted = weighted_mesh_error(
      body_, body_.unknowns_of(state.cell_u, state.face_u),
      body_.known_of({state.cell_u, state.face_u, fields_.point_displacement()}), pressure);
  return std::isnan(weighted) ? weighted : std::max(known, weighted);
}

void SolidErrorEstimate::see_step() {
  if (!body_.is_dynamic()) return;
  const SolidState &now = stepper_.trial(), &before = stepper_.state();
  const std::size_t n = std::size_t(body_.mesh().cells.n_owned()) * body_.mesh().dim;
  const auto norm = [this](std::span<const double> cells) { return std::sqrt(mean_square(cells)); };
  const time::StepErrors::Seen step =
      steps_.add(std::span(before.cell_v).first(n), std::span(now.cell_v).first(n), now.dt, before.dt,
                 norm(now.cell_u), norm);
  linear_.add({.error = left_by_solver() * step.size, .rate = step.rate, .size = step.size, .dt = step.dt});
  if (body_.equilibrium().means().compares_gradients) see_swing(now, step);
}

/// Half of u . K u is the strain energy, of the gradients without an energy nearly so.
void SolidErrorEstimate::see_swing(const SolidState& now, const time::StepErrors::Seen& step) {
  const MPI_Comm comm = body_.mesh().comm;
  const std::vector<double> u = body_.unknowns_of(now.cell_u, now.face_u);
  std::vector<double> force(u.size());
  body_.kernel().apply(u, now.known, force);
  const double strain =
      0.5 * std::abs(parallel::sum(comm, std::inner_product(u.begin(), u.end(), force.begin(), 0.0)));
  drift_.add(now.dt, step.rate, step.size, parallel::sum(comm, stepper_.ledger().kinetic(now)), strain);
}

diagnostics::ErrorParts SolidErrorEstimate::parts() const {
  diagnostics::ErrorParts parts;
  parts.dimension = body_.mesh().dim;
  if (stepper_.state().steps == 0) return parts;
  const bool compares = body_.equilibrium().means().compares_gradients;
  if (body_.is_dynamic()) {
    parts.step = steps_.over_size();
    parts.linear = linear_.over_size();
  } else {
    parts.linear = compares ? missed_work() : left_by_solver();
  }
  if (!compares) {
    parts.mesh = finite_mesh_error();
    return parts;
  }
  const StrainAudit audit = judge_.compared();
  parts.mesh = std::max(audit.mismatch(), audit.missed_by_mesh(body_.mesh().dim));
  if (!(audit.strain_energy > 0)) parts.mesh = diagnostics::ErrorParts::unknown;
  if (body_.is_dynamic()) parts.mesh += drift_.over_size(parts.mesh);
  add_loads(parts);
  if (body_.parameters().expansion) parts.mesh = thermal_mesh_error(parts.mesh);
  return parts;
}

void SolidErrorEstimate::save(io::CheckpointWriter& file) const {
  file.write_common("error-of-solver", linear_.state());
  file.write_common("error-drift", drift_.state());
  file.write_common("error-steps", steps_.numbers());
  file.write(mesh::Entries::owned_cells, "error-velocity-before", steps_.before());
}

void SolidErrorEstimate::load(io::CheckpointReader& file) {
  linear_.restore(file.read_common("error-of-solver"));
  std::array<double, PhaseDrift::n_values> drift{};
  file.read_common("error-drift", drift);
  drift_.restore(drift);
  const std::vector<double> steps = file.read_common("error-steps");
  steps_.restore(steps, file.read_or_none(mesh::Entries::owned_cells, "error-velocity-before",
                                          std::size_t(body_.mesh().dim)));
}

}  // namespace couplet::solid
