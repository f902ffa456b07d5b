// SPDX-License-Identifier: Apache-2.0
// Energies of the step under way; part of a run only if they are asked for.
#include <algorithm>

#include "common/parallel/collective.hpp"
#include "solid_solver/output.hpp"
#include "solid_solver/solid.hpp"
#include "solid_solver/system.hpp"

namespace couplet {
namespace {

Vec3 at(std::span<const double> values, Index i, int dim) {
  Vec3 u = Vec3::Zero();
  for (int a = 0; a < dim; ++a) u[a] = values[std::size_t(i) * dim + a];
  return u;
}

}  // namespace

/// Work of the stress of one displacement (local cells, boundary faces, points) on the change of another,
/// over all faces: sum of sigma . S . jump. `on_boundary`: the share of the boundary's forces on the
/// boundary's change.
double Solid::stress_work(const Placed& stressed, std::span<const double> cell_change,
                          std::span<const double> face_change, double* on_boundary) const {
  const int dim = mesh_.dim;
  const Index n_owned = mesh_.cells.n_owned();
  const std::vector<Tensor3> gradients =
      face_gradients(0, mesh_.n_flux_faces(), stressed.cells, stressed.faces, stressed.points);
  double work = 0, outside = 0;
  for (Index f = 0; f < mesh_.n_flux_faces(); ++f) {
    const Index owner = mesh_.owner[f];
    if (owner >= n_owned) continue;  // another rank's
    const Vec3& area = mesh_.reference.face_area[f];
    Vec3 force = elastic_.stress(owner, gradients[f]) * area;
    const Vec3 here = at(cell_change, owner, dim);
    if (f < mesh_.n_interior) {
      work += force.dot(at(cell_change, mesh_.neighbour[f], dim) - here);
    } else if (elastic_.condition(f) == ElasticCondition::symmetry) {
      work -= area.dot(force) * area.dot(here) / area.squaredNorm();
    } else {
      const Vec3 there = at(face_change, f - mesh_.n_interior, dim);
      work += force.dot(there - here);
      outside += force.dot(there);
    }
  }
  if (on_boundary) *on_boundary = outside;
  return work;
}

double Solid::kinetic_energy(const SolidState& state, std::span<const double> known_rate) const {
  const std::span<const double> velocity = state.cell_v;
  const int dim = mesh_.dim;
  if (has_mass_) {
    const std::vector<double> rates = unknowns_of(state.cell_v, state.face_v);
    return 0.5 * kernel_.product(ElasticPart::mass, {rates, known_rate}, {rates, known_rate});
  }
  double energy = 0;
  for (Index c = 0; c < mesh_.cells.n_owned(); ++c)
    energy += 0.5 * density(c) * mesh_.reference.volume[c] * at(velocity, c, dim).squaredNorm();
  return energy;
}

/// Displacements w of the solve with ghosts and points, from the packed unknowns.
Solid::Placed Solid::place_unknowns(const StageWork& work) const {
  const int dim = mesh_.dim;
  const std::size_t n_cells = std::size_t(mesh_.cells.n_owned()) * dim;
  Placed placed;
  placed.cells.assign(std::size_t(mesh_.cells.n_local()) * dim, 0);
  placed.faces.assign(std::size_t(mesh_.boundary.n_local()) * dim, 0);
  std::copy_n(unknowns_.begin(), n_cells, placed.cells.begin());
  const auto& free = elastic_.unknown_faces();
  for (std::size_t i = 0; i < free.size(); ++i)
    for (int a = 0; a < dim; ++a)
      placed.faces[std::size_t(free[i] - mesh_.n_interior) * dim + a] = unknowns_[n_cells + i * dim + a];
  elastic_.impose_known(work.known, placed.faces);
  mesh_.cells.update_ghosts(placed.cells, dim);
  mesh_.boundary.update_ghosts(placed.faces, dim);
  elastic_.join_twins(placed.faces);
  placed.points = to_points(placed.cells, placed.faces, work.known);
  return placed;
}

/// After a stage: `before` is the state at its start, trial_ that at its end.
void Solid::add_work(const StageWork& work, const SolidState& before) {
  const int dim = mesh_.dim;
  SolidEnergies& energies = trial_.energies;
  std::vector<double> cells(trial_.cell_u.size()), faces(trial_.face_u.size());
  for (std::size_t i = 0; i < cells.size(); ++i) cells[i] = trial_.cell_u[i] - before.cell_u[i];
  for (std::size_t i = 0; i < faces.size(); ++i) faces[i] = trial_.face_u[i] - before.face_u[i];
  mesh_.cells.update_ghosts(cells, dim);
  // Supports: the change over the stage, which the state of the faces may not hold yet.
  elastic_.impose_known(work.known_change, faces);
  mesh_.boundary.update_ghosts(faces, dim);
  elastic_.join_twins(faces);
  double outside = 0;
  const double inside = stress_work(place_unknowns(work), cells, faces, &outside);
  // Body forces and effects stand in the rows without the known force of the faces.
  const std::size_t n_cells = std::size_t(mesh_.cells.n_owned()) * dim;
  for (std::size_t i = 0; i < n_cells; ++i) outside += work.loads[i] * cells[i];
  const auto& free = elastic_.unknown_faces();
  for (std::size_t i = 0; i < free.size(); ++i) {
    if (elastic_.condition(free[i]) == ElasticCondition::bonded) continue;  // their cells take the stress
    for (int a = 0; a < dim; ++a)
      outside -= work.loads[n_cells + i * dim + a] * cells[std::size_t(mesh_.owner[free[i]]) * dim + a];
  }
  const SolidDamping damping = parameters_.damping.value_or(SolidDamping{});
  const double dt = work.stage.dt, beta = damping.stiffness;
  double loss = 0;
  if (beta > 0) {
    // sigma(w) = sigma(x) + beta sigma(v); v is the change over the stage by its length.
    Placed rate{cells, faces, {}};
    rate.points = to_points(rate.cells, rate.faces, work.known_change);
    loss = beta / dt * stress_work(rate, cells, faces, nullptr);
  }
  energies.internal_work += inside - loss;
  for (Index c = 0; c < mesh_.cells.n_owned(); ++c)
    loss += damping.mass / dt * density(c) * mesh_.reference.volume[c] * at(cells, c, dim).squaredNorm();
  energies.damping_loss += loss;
  energies.external_work += outside;
  energies.kinetic = kinetic_energy(trial_, known_rate_);
}

/// The same with the symmetric kernel, whose own products these are: all that acts by its trial functions.
void Solid::add_symmetric_work(const StageWork& work, const SolidState& before) {
  if (finite_) return add_finite_work(work, before);
  SolidEnergies& energies = trial_.energies;
  std::vector<double> change = unknowns_of(trial_.cell_u, trial_.face_u);
  const std::vector<double> start = unknowns_of(before.cell_u, before.face_u);
  for (std::size_t i = 0; i < change.size(); ++i) change[i] -= start[i];
  const ElasticField w{unknowns_, work.known}, moved{change, work.known_change};
  if (parameters_.time_scheme.type != TimeScheme::trapezoidal) mean_of_ends(work);
  double outside = -kernel_.product(ElasticPart::springs, w, moved);
  for (std::size_t i = 0; i < change.size(); ++i) outside += load_rows_[i] * change[i];
  if (!prescribed_.is_zero()) outside += known_work(work, before);
  const SolidDamping damping = parameters_.damping.value_or(SolidDamping{});
  double loss = damping.stiffness > 0 ? damping.stiffness / work.stage.dt *
                                            kernel_.product(ElasticPart::stiffness, moved, moved)
                                      : 0;
  energies.internal_work += kernel_.product(ElasticPart::stiffness, w, moved) - loss;
  if (damping.mass > 0)
    loss += damping.mass / work.stage.dt * kernel_.product(ElasticPart::mass, moved, moved);
  energies.damping_loss += loss;
  energies.external_work += outside;
  energies.kinetic = kinetic_energy(trial_, known_rate_);
}

/// The loads of a stage at its place become the mean of those at its ends, whose work on the change is second
/// order.
void Solid::mean_of_ends(const StageWork& work) {
  const auto rows_at = [&](double t) {
    std::vector<double> rows(elastic_.n_unknowns(), 0);
    const std::vector<double> body = body_forces(t);
    if (!body.empty()) kernel_.add_cell_forces(body, rows);
    for (const auto& effect : effects_) effect->add_loads(t, kernel_, rows);
    std::vector<double> faces(std::size_t(mesh_.boundary.n_owned()) * mesh_.dim, 0);
    boundaries_.add_forces(t, faces);
    kernel_.add_face_forces(faces, rows);
    return rows;
  };
  const std::vector<double> start = rows_at(work.start_time), place = rows_at(work.place_time),
                            end = rows_at(work.end_time);
  for (std::size_t i = 0; i < load_rows_.size(); ++i) load_rows_[i] += 0.5 * (start[i] + end[i]) - place[i];
}

/// What holds the known nodes does on their change: against stress and inertia.
double Solid::known_work(const StageWork& work, const SolidState& before) const {
  const std::vector<double> still(unknowns_.size(), 0);
  double sum = kernel_.product(ElasticPart::stiffness, {unknowns_, work.known}, {still, work.known_change});
  const std::vector<double> of_known = known_inertia(work);
  if (of_known.empty()) return sum;
  // The mean over the stage, which the trapezoidal rule has at its place.
  const std::vector<double> after = unknowns_of(trial_.cell_v, trial_.face_v);
  std::vector<double> rate = unknowns_of(before.cell_v, before.face_v);
  const double alpha = parameters_.damping ? parameters_.damping->mass : 0;
  for (std::size_t i = 0; i < rate.size(); ++i)
    rate[i] = (after[i] - rate[i]) / work.stage.dt + alpha * 0.5 * (after[i] + rate[i]);
  return sum + kernel_.product(ElasticPart::mass, {rate, of_known}, {still, work.known_change});
}

/// Of body forces, tractions, pressures and the interface over a stage: what the audit holds against the
/// energy found. Moving supports and effects do work that is not counted; no audit then.
void Solid::add_load_work(const StageWork& work, std::span<const double> interface_load,
                          std::span<const double> cells_before, std::span<const double> faces_before) {
  const int dim = mesh_.dim;
  double sum = 0;
  if (has_mass_) {
    for (std::size_t i = 0; i < std::size_t(mesh_.cells.n_owned()) * dim; ++i)
      sum += load_rows_[i] * (trial_.cell_u[i] - cells_before[i]);
    std::size_t row = std::size_t(mesh_.cells.n_owned()) * dim;
    for (const Index f : elastic_.unknown_faces())
      for (int a = 0; a < dim; ++a) {
        const std::size_t b = std::size_t(f - mesh_.n_interior) * dim + a;
        sum += load_rows_[row++] * (trial_.face_u[b] - faces_before[b]);
      }
    trial_.load_work += sum;
    return;
  }
  if (!work.rhs.empty())
    for (std::size_t i = 0; i < std::size_t(mesh_.cells.n_owned()) * dim; ++i)
      sum += work.rhs[i] * (trial_.cell_u[i] - cells_before[i]);
  for (const Index f : elastic_.unknown_faces())
    for (int a = 0; a < dim; ++a) {
      const std::size_t b = std::size_t(f - mesh_.n_interior) * dim + a;
      const double force = work.face_force[b] + (interface_load.empty() ? 0 : interface_load[b]);
      sum += force * (trial_.face_u[b] - faces_before[b]);
    }
  trial_.load_work += sum;
}

SolidEnergies Solid::energies(std::span<const double> points) const {
  SolidEnergies e = state_.energies;
  e.conserving = parameters_.time_scheme.type == TimeScheme::trapezoidal;
  if (kernel_.is_symmetric()) {
    const std::vector<double> unknowns = unknowns_of(state_.cell_u, state_.face_u);
    if (finite_) {
      e = summed(e);
      e.strain = finite_->energy(unknowns, known_accepted_);
      return e;
    }
    const ElasticField u{unknowns, known_accepted_};
    e.strain = 0.5 * kernel_.product(ElasticPart::stiffness, u, u);
    return summed(e);
  }
  const Placed now{state_.cell_u, state_.face_u, {points.begin(), points.end()}};
  e.strain = 0.5 * stress_work(now, state_.cell_u, state_.face_u, nullptr);
  return summed(e);
}

SolidEnergies Solid::summed(SolidEnergies e) const {
  for (double* part :
       {&e.kinetic, &e.initial_kinetic, &e.strain, &e.internal_work, &e.external_work, &e.damping_loss})
    *part = sum(mesh_.comm, *part);
  return e;
}

}  // namespace couplet
