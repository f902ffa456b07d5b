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

double Solid::kinetic_energy(std::span<const double> velocity) const {
  const int dim = mesh_.dim;
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
  energies.kinetic = kinetic_energy(trial_.cell_v);
}

SolidEnergies Solid::energies(std::span<const double> points) const {
  SolidEnergies e = state_.energies;
  const Placed now{state_.cell_u, state_.face_u, {points.begin(), points.end()}};
  e.strain = 0.5 * stress_work(now, state_.cell_u, state_.face_u, nullptr);
  for (double* part :
       {&e.kinetic, &e.initial_kinetic, &e.strain, &e.internal_work, &e.external_work, &e.damping_loss})
    *part = sum(mesh_.comm, *part);
  return e;
}

}  // namespace couplet
