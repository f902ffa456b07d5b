// SPDX-License-Identifier: Apache-2.0
#include "solid_solver/motion/ledger.hpp"

#include <utility>

#include "common/elasticity/node_fields.hpp"
#include "common/elasticity/vector_at.hpp"
#include "common/parallel/collective.hpp"

namespace couplet::solid {

namespace {

/// Displacement including ghosts and points.
struct Placed {
  std::vector<double> cells, faces, points;
  BodyField field() const { return {cells, faces, points}; }
};

/// The displacement w of a solve, from the packed unknowns. Collective.
Placed place_unknowns(const SolidBody& body, const StageWork& work, std::span<const double> unknowns) {
  const mesh::Mesh& mesh = body.mesh();
  const int dim = mesh.dim;
  auto [cells, faces] = elastic::fields_of_unknowns(mesh, body.elastic(), unknowns);
  Placed placed{std::move(cells), std::move(faces), {}};
  placed.cells.resize(std::size_t(mesh.cells.n_local()) * dim, 0);
  placed.faces.resize(std::size_t(mesh.boundary.n_local()) * dim, 0);
  body.elastic().impose_known(work.known, placed.faces);
  mesh.cells.update_ghosts(placed.cells, dim);
  mesh.boundary.update_ghosts(placed.faces, dim);
  body.elastic().join_twins(placed.faces);
  placed.points = body.to_points(placed.cells, placed.faces, work.known);
  return placed;
}

}  // namespace

SolidLedger::SolidLedger(const SolidBody& body)
    : body_(body),
      mesh_(body.mesh()),
      geometry_(body.geometry()),
      parameters_(body.parameters()),
      damping_(parameters_.damping.value_or(SolidDamping{})),
      elastic_(body.elastic()),
      kernel_(body.kernel()) {}

/// Work of the stress of one displacement on the change of another over all faces: sum of sigma . S . jump.
/// `on_boundary`: part of the boundary forces.
double SolidLedger::stress_work(const BodyField& stressed, const BodyField& change,
                                double* on_boundary) const {
  const int dim = mesh_.dim;
  const Index n_owned = mesh_.cells.n_owned();
  const std::vector<Tensor3> gradients = body_.face_gradients(0, mesh_.n_flux_faces(), stressed);
  double work = 0, outside = 0;
  for (Index f = 0; f < mesh_.n_flux_faces(); ++f) {
    const Index owner = mesh_.owner[f];
    if (owner >= n_owned) continue;  // another rank's
    const Vec3& area = geometry_.face_area[f];
    Vec3 force = elastic_.stress(owner, gradients[f]) * area;
    const Vec3 here = elastic::vector_at(change.cells, owner, dim);
    if (f < mesh_.n_interior) {
      work += force.dot(elastic::vector_at(change.cells, mesh_.neighbour[f], dim) - here);
    } else if (elastic_.mirrored(f)) {
      work -= area.dot(force) * area.dot(here) / area.squaredNorm();
    } else {
      const Vec3 there = elastic::vector_at(change.faces, f - mesh_.n_interior, dim);
      work += force.dot(there - here);
      outside += force.dot(there);
    }
  }
  if (on_boundary) *on_boundary = outside;
  return work;
}

double SolidLedger::kinetic(const SolidState& state) const { return kinetic(state, state.known_rate); }

double SolidLedger::initial_kinetic(const SolidState& start, double dt) const {
  std::vector<double> rate(start.known_rate.size());
  body_.prescribed().evaluate_rate(start.time, dt, rate);
  return kinetic(start, rate);
}

double SolidLedger::kinetic(const SolidState& state, std::span<const double> known_rate) const {
  const int dim = mesh_.dim;
  if (body_.has_mass()) {
    const std::vector<double> rates = body_.unknowns_of(state.cell_v, state.face_v);
    return 0.5 * kernel_.product(elastic::ElasticPart::mass, {rates, known_rate}, {rates, known_rate});
  }
  double energy = 0;
  for (Index c = 0; c < mesh_.cells.n_owned(); ++c)
    energy +=
        0.5 * body_.density(c) * geometry_.volume[c] * elastic::vector_at(state.cell_v, c, dim).squaredNorm();
  return energy;
}

void SolidLedger::add_work(const SolvedStage& stage) const {
  const Work work = !body_.has_mass()      ? face_work(stage)
                    : body_.large_strain() ? finite_work(stage)
                                           : symmetric_work(stage);
  SolidEnergies& energies = stage.after.energies;
  energies.internal_work += work.inside;
  energies.external_work += work.outside;
  energies.damping_loss += work.loss;
  energies.kinetic = kinetic(stage.after);
}

/// The work computed from face forces.
SolidLedger::Work SolidLedger::face_work(const SolvedStage& stage) const {
  const auto& [work, last, before, after] = stage;
  const int dim = mesh_.dim;
  std::vector<double> cells(after.cell_u.size()), faces(after.face_u.size());
  for (std::size_t i = 0; i < cells.size(); ++i) cells[i] = after.cell_u[i] - before.cell_u[i];
  for (std::size_t i = 0; i < faces.size(); ++i) faces[i] = after.face_u[i] - before.face_u[i];
  mesh_.cells.update_ghosts(cells, dim);
  // Supports use the change over the stage, which the state of the faces may lack.
  elastic_.impose_known(work.known_change, faces);
  mesh_.boundary.update_ghosts(faces, dim);
  elastic_.join_twins(faces);
  const BodyField change{cells, faces, {}};
  double outside = 0;
  const double inside = stress_work(place_unknowns(body_, work, last.unknowns).field(), change, &outside);
  // The rows contain body forces and effects without the known face forces.
  const std::size_t n_cells = std::size_t(mesh_.cells.n_owned()) * dim;
  for (std::size_t i = 0; i < n_cells; ++i) outside += work.loads[i] * cells[i];
  const auto& free = elastic_.unknown_faces();
  for (std::size_t i = 0; i < free.size(); ++i) {
    if (elastic_.at(free[i]).shared) continue;  // their cells take the stress
    for (int a = 0; a < dim; ++a)
      outside -= work.loads[n_cells + i * dim + a] * cells[std::size_t(mesh_.owner[free[i]]) * dim + a];
  }
  const double dt = work.stage.dt, beta = damping_.stiffness;
  double loss = 0;
  if (beta > 0) {
    // sigma(w) = sigma(x) + beta sigma(v); v is the change over the stage divided by its length.
    const std::vector<double> points = body_.to_points(cells, faces, work.known_change);
    loss = beta / dt * stress_work({cells, faces, points}, change, nullptr);
  }
  double mass_loss = 0;
  for (Index c = 0; c < mesh_.cells.n_owned(); ++c)
    mass_loss += damping_.mass / dt * body_.density(c) * geometry_.volume[c] *
                 elastic::vector_at(cells, c, dim).squaredNorm();
  return {inside - loss, outside, loss + mass_loss};
}

std::vector<double> SolidLedger::change_over(const SolvedStage& stage) const {
  std::vector<double> change = body_.unknowns_of(stage.after.cell_u, stage.after.face_u);
  const std::vector<double> start = body_.unknowns_of(stage.before.cell_u, stage.before.face_u);
  for (std::size_t i = 0; i < change.size(); ++i) change[i] -= start[i];
  return change;
}

/// For the symmetric kernel, whose own products these are: work of all forces by its trial functions.
SolidLedger::Work SolidLedger::symmetric_work(const SolvedStage& stage) const {
  const auto& [work, last, before, after] = stage;
  const std::vector<double> change = change_over(stage);
  const elastic::ElasticField w{last.unknowns, work.known}, moved{change, work.known_change};
  const std::vector<double> loads = mean_of_ends(work, last.load_rows);
  double outside = -kernel_.product(elastic::ElasticPart::springs, w, moved);
  for (std::size_t i = 0; i < change.size(); ++i) outside += loads[i] * change[i];
  if (!body_.prescribed().is_zero()) outside += known_work(stage);
  const double dt = work.stage.dt, inside = kernel_.product(elastic::ElasticPart::stiffness, w, moved);
  double loss = 0, mass_loss = 0;
  if (damping_.stiffness > 0)
    loss = damping_.stiffness / dt * kernel_.product(elastic::ElasticPart::stiffness, moved, moved);
  if (damping_.mass > 0)
    mass_loss = damping_.mass / dt * kernel_.product(elastic::ElasticPart::mass, moved, moved);
  return {inside - loss, outside, loss + mass_loss};
}

/// At large strain: work of the scheme's internal force at its place on the change over the stage.
SolidLedger::Work SolidLedger::finite_work(const SolvedStage& stage) const {
  const auto& [work, last, before, after] = stage;
  const std::vector<double> change = change_over(stage);
  const std::vector<double> loads = mean_of_ends(work, last.load_rows);
  const std::vector<double> force = body_.equilibrium().forces(last.unknowns, work.known);
  Work done;
  for (std::size_t i = 0; i < change.size(); ++i) {
    done.inside += force[i] * change[i];
    done.outside += loads[i] * change[i];
  }
  const elastic::ElasticField moved{change, work.known_change};
  if (damping_.mass > 0)
    done.loss = damping_.mass / work.stage.dt * kernel_.product(elastic::ElasticPart::mass, moved, moved);
  return done;
}

/// For schemes other than the trapezoidal rule: mean of the loads at both ends of a stage, whose work on the
/// change is second order.
std::vector<double> SolidLedger::mean_of_ends(const StageWork& work,
                                              const std::vector<double>& at_place) const {
  std::vector<double> rows = at_place;
  if (scheme_of(parameters_).type == time::TimeScheme::trapezoidal) return rows;
  const auto rows_at = [&](double t) {
    std::vector<double> at_time(elastic_.n_unknowns(), 0);
    const std::vector<double> body = body_.body_forces(t);
    if (!body.empty()) kernel_.add_cell_forces(body, at_time);
    if (body_.thermal()) body_.thermal()->add_loads(t, kernel_, at_time);
    std::vector<double> faces(body_.boundaries().n_forces(), 0);
    body_.boundaries().add_forces(t, faces);
    kernel_.add_face_forces(faces, at_time);
    return at_time;
  };
  const std::vector<double> start = rows_at(work.start_time), place = rows_at(work.place_time),
                            end = rows_at(work.end_time);
  for (std::size_t i = 0; i < rows.size(); ++i) rows[i] += 0.5 * (start[i] + end[i]) - place[i];
  return rows;
}

SolidEnergies SolidLedger::total(const SolidState& state, std::span<const double> points) const {
  SolidEnergies e = state.energies;
  e.conserving = scheme_of(parameters_).type == time::TimeScheme::trapezoidal;
  if (kernel_.is_symmetric()) {
    e = summed(e);
    e.contact = contact(state);
    e.initial_contact = initial_contact();
    e.strain = body_.equilibrium().energy(body_.unknowns_of(state.cell_u, state.face_u), state.known);
    return e;
  }
  const BodyField now{state.cell_u, state.face_u, points};
  e.strain = 0.5 * stress_work(now, now, nullptr);
  return summed(e);
}

double SolidLedger::contact(const SolidState& state) const {
  const Seat* seat = body_.seat();
  if (!seat || seat->is_rigid()) return 0;  // a rigid seat keeps nothing
  return seat->look(seat->penetration(body_.unknowns_of(state.cell_u, state.face_u), state.known), {}).energy;
}

double SolidLedger::initial_contact() const {
  const Seat* seat = body_.seat();
  if (!seat || seat->is_rigid()) return 0;
  const std::vector<double> still(elastic_.n_unknowns(), 0);
  return seat->look(seat->penetration(still, {}), {}).energy;
}

SolidEnergies SolidLedger::summed(SolidEnergies e) const {
  for (double* part :
       {&e.kinetic, &e.initial_kinetic, &e.strain, &e.internal_work, &e.external_work, &e.damping_loss})
    *part = parallel::sum(mesh_.comm, *part);
  return e;
}

// Work of the supports and their loads.

/// Work of the supports on known nodes. Against stress, springs and damping it uses their change, against
/// inertia their mean velocities, so that the kinetic energies balance to round-off.
double SolidLedger::known_work(const SolvedStage& stage) const {
  const auto& [work, last, before, trial] = stage;
  const double dt = work.stage.dt;
  const std::vector<double> still(last.unknowns.size(), 0);
  const elastic::ElasticField w{last.unknowns, work.known}, known{still, work.known_change};
  double sum = kernel_.product(elastic::ElasticPart::stiffness, w, known) +
               kernel_.product(elastic::ElasticPart::springs, w, known);
  if (!body_.prescribed().uses_time()) return sum;  // not by the size: a rank may hold nothing
  // Mean over the stage, which is the place of the trapezoidal rule.
  const std::vector<double> after = body_.unknowns_of(trial.cell_v, trial.face_v);
  std::vector<double> rate = body_.unknowns_of(before.cell_v, before.face_v), velocity = rate;
  for (std::size_t i = 0; i < rate.size(); ++i) {
    velocity[i] = 0.5 * (after[i] + rate[i]);
    rate[i] = (after[i] - rate[i]) / dt;
  }
  const double start = work.place_time - 0.5 * dt;
  std::vector<double> way(before.known_rate.size());  // whose rate at the start of the run nobody has set
  body_.prescribed().evaluate_rate(start, dt, way);
  for (std::size_t i = 0; i < way.size(); ++i) way[i] = 0.5 * dt * (way[i] + trial.known_rate[i]);
  sum +=
      kernel_.product(elastic::ElasticPart::mass, {rate, body_.known_acceleration(start, dt)}, {still, way});
  if (damping_.mass > 0)
    sum += damping_.mass * kernel_.product(elastic::ElasticPart::mass,
                                           {velocity, body_.known_velocity(start, dt)},
                                           {still, work.known_change});
  return sum;
}

void SolidLedger::add_load_work(const StageWork& work, const LastSolve& last, const BodyField& before,
                                SolidState& after) const {
  const std::size_t dim = mesh_.dim, n_cells = std::size_t(mesh_.cells.n_owned()) * dim;
  std::vector<double> change = body_.unknowns_of(after.cell_u, after.face_u);
  const std::vector<double> start = body_.unknowns_of(before.cells, before.faces);
  for (std::size_t i = 0; i < change.size(); ++i) change[i] -= start[i];
  std::vector<double> forces = work.rhs;  // without a mass of faces only those of cells
  if (body_.has_mass()) {
    forces = last.load_rows;
  } else {
    forces.resize(n_cells, 0);
    for (const Index f : elastic_.unknown_faces())
      for (std::size_t a = 0; a < dim; ++a) {
        const std::size_t b = std::size_t(f - mesh_.n_interior) * dim + a;
        forces.push_back(work.face_force[b] + (last.interface.empty() ? 0 : last.interface[b]));
      }
  }
  for (std::size_t i = 0; i < change.size(); ++i) after.load_work += forces[i] * change[i];
}

}  // namespace couplet::solid
