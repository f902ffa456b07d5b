// SPDX-License-Identifier: Apache-2.0

// Heat in files, at points and faces, through patches, and solutions of its matrix for other data.
#include <algorithm>
#include <cmath>
#include <utility>

#include "common/base/error.hpp"
#include "common/io/checkpoint.hpp"
#include "common/parallel/collective.hpp"
#include "solid_solver/thermal/heat.hpp"

namespace couplet::solid {

/// Known values as fields, zero elsewhere: per local point, per boundary face of owned cells.
std::pair<std::vector<double>, std::vector<double>> Heat::known_fields() const {
  std::pair<std::vector<double>, std::vector<double>> fields;
  fields.first.assign(mesh_->points.n_local(), 0.);
  fields.second.assign(mesh_->boundary.n_owned(), 0.);
  std::size_t i = 0;
  for (const Index v : conduction_.known_points()) fields.first[v] = state_.known[i++];
  for (const Index f : conduction_.known_faces()) fields.second[f - mesh_->n_interior] = state_.known[i++];
  return fields;
}

void Heat::save(io::CheckpointWriter& file) const {
  file.write(mesh::Entries::cells, "cell-temperature", state_.cells);
  file.write(mesh::Entries::boundary, "face-temperature", state_.boundary);
  const auto [points, faces] = known_fields();
  file.write(mesh::Entries::points, "known-temperature", points);
  file.write(mesh::Entries::owned_boundary, "known-face-temperature", faces);
  file.write(mesh::Entries::owned_cells, "enthalpy", state_.enthalpy);
  file.write(mesh::Entries::owned_cells, "enthalpy-before", state_.enthalpy_before);
  file.write(mesh::Entries::owned_cells, "heat-inflow", state_.inflow);
  file.write_scalar("heat-time", state_.time);
  file.write_scalar("heat-dt", state_.dt);
  file.write_scalar("heat-steps", state_.steps);
}

void Heat::load(io::CheckpointReader& file) {
  file.read(mesh::Entries::cells, "cell-temperature", state_.cells);
  file.read(mesh::Entries::boundary, "face-temperature", state_.boundary);
  auto [points, faces] = known_fields();
  file.read(mesh::Entries::points, "known-temperature", points);
  file.read(mesh::Entries::owned_boundary, "known-face-temperature", faces);
  std::size_t i = 0;
  for (const Index v : conduction_.known_points()) state_.known[i++] = points[v];
  for (const Index f : conduction_.known_faces()) state_.known[i++] = faces[f - mesh_->n_interior];
  file.read(mesh::Entries::owned_cells, "enthalpy", state_.enthalpy);
  file.read(mesh::Entries::owned_cells, "enthalpy-before", state_.enthalpy_before);
  file.read(mesh::Entries::owned_cells, "heat-inflow", state_.inflow);
  state_.time = file.read_scalar("heat-time");
  state_.dt = file.read_scalar("heat-dt");
  state_.steps = static_cast<int>(file.read_scalar("heat-steps"));
}

// Results from the temperature: values at points and faces, heat through patches, neglected effects.

std::vector<double> Heat::point_temperature(const HeatState& state) const {
  std::vector<double> points(mesh_->points.n_local());
  conduction_.point_values(state.cells, state.boundary, state.known, points);
  return points;
}

std::vector<double> Heat::face_temperature(const HeatState& state) const {
  const std::vector<double> points = point_temperature(state);
  std::vector<double> values(mesh_->n_flux_faces());
  for (Index f = 0; f < mesh_->n_flux_faces(); ++f)
    values[f] = conduction_.face_value(f, state.cells, state.boundary, points);
  return values;
}

std::vector<double> Heat::face_heat() const {
  std::vector<double> conductivity(mesh_->n_faces()), heat(mesh_->n_flux_faces());
  set_conductivity(state_, conductivity);
  conduction_.face_heat(conductivity, state_.cells, state_.boundary, point_temperature(state_), heat);
  return heat;
}

std::vector<double> Heat::boundary_inflow() const {
  const std::vector<double> heat = face_heat();
  std::vector<double> inflow(mesh_->boundary.n_owned(), 0);
  for (std::size_t b = 0; b < inflow.size(); ++b) {
    const Index f = mesh_->n_interior + Index(b);
    if (conduction_.condition(f) != fv::HeatCondition::symmetry)
      inflow[b] = heat[f] / geometry_->face_area[f].norm();
  }
  return inflow;
}

std::vector<PatchHeat> Heat::patch_heat() const {
  const std::vector<double> heat = face_heat();
  std::vector<PatchHeat> result;
  for (const mesh::Patch& patch : mesh_->patches) {
    if (patch.bonded) continue;
    double through = 0;
    for (Index f = patch.first; f < patch.first + patch.count; ++f)
      if (conduction_.condition(f) != fv::HeatCondition::symmetry) through += heat[f];
    result.push_back({patch.name, parallel::sum(mesh_->comm, through)});
  }
  return result;
}

double Heat::stored_heat() const {
  double heat = 0;
  for (Index c = 0; c < mesh_->cells.n_owned(); ++c)
    heat += materials_[mesh_->cell_zone[c]].density * geometry_->volume[c] * state_.enthalpy[c];
  return parallel::sum(mesh_->comm, heat);
}

HeatState Heat::answer(std::vector<double> sources, std::vector<double> known) const {
  if (!is_steady() || properties_vary_ || state_.steps == 0)
    throw Error("Only a steady temperature that was solved for, with constant conductivity, has a dual.");
  HeatState answer;
  answer.known = std::move(known);
  conduction_.subtract_known({conductivity_, transfer_, capacity_, 1}, answer.known, sources);
  std::vector<double> unknowns(sources.size(), 0);
  solver_->solve(sources, unknowns);
  const auto n_owned = std::size_t(mesh_->cells.n_owned());
  answer.cells.assign(std::size_t(mesh_->cells.n_local()), 0);
  answer.boundary.assign(std::size_t(mesh_->boundary.n_local()), 0);
  std::copy_n(unknowns.begin(), n_owned, answer.cells.begin());
  const auto& faces = conduction_.flux_faces();
  for (std::size_t i = 0; i < faces.size(); ++i)
    answer.boundary[std::size_t(faces[i] - mesh_->n_interior)] = unknowns[n_owned + i];
  const auto& fixed = conduction_.known_faces();
  for (std::size_t i = 0; i < fixed.size(); ++i)
    answer.boundary[std::size_t(fixed[i] - mesh_->n_interior)] =
        answer.known[conduction_.known_points().size() + i];
  mesh_->cells.update_ghosts(answer.cells);
  mesh_->boundary.update_ghosts(answer.boundary);
  conduction_.join_twins(answer.boundary);
  return answer;
}

// (C/dt + theta K) x = C/dt change; the next change is x by Euler, and 2 x - change by the trapezoidal rule.
std::vector<double> Heat::next_change(std::span<const double> change) const {
  std::vector<double> rhs(conduction_.n_unknowns(), 0), next(conduction_.n_unknowns(), 0);
  for (std::size_t i = 0; i < capacity_.size(); ++i) rhs[i] = capacity_[i] * change[i];
  solver_->solve(rhs, next);
  next.resize(capacity_.size());
  if (parameters_.scheme == HeatParameters::Scheme::trapezoidal)
    for (std::size_t i = 0; i < next.size(); ++i) next[i] = 2 * next[i] - change[i];
  return next;
}

std::vector<double> Heat::transfer() const {
  std::vector<double> all = transfer_;
  for (std::size_t i = 0; i < all.size(); ++i)
    all[i] *= geometry_->face_area[conduction_.flux_faces()[i]].norm();
  return all;
}

// The pyramid-weighted mean of the face values differs from the center value 3/dim times as much as the mean
// of a quadratic source in a regular cell.
std::vector<double> Heat::source_missed() const {
  std::vector<double> missed;
  if (source_.is_zero()) return missed;
  missed.assign(std::size_t(mesh_->cells.n_owned()), 0);
  const mesh::Geometry& g = *geometry_;
  const auto add = [&](Index c, Index f, const Vec3& shift) {
    if (c >= mesh_->cells.n_owned()) return;
    const Vec3 at = g.face_centre[f] - shift;
    const double pyramid = std::abs(g.face_area[f].dot(at - g.cell_centre[c])) / mesh_->dim;
    missed[std::size_t(c)] +=
        mesh_->dim / 3. * pyramid * (source_(at, state_.time) - source_(g.cell_centre[c], state_.time));
  };
  for (Index f = 0; f < mesh_->n_flux_faces(); ++f) {
    add(mesh_->owner[f], f, Vec3::Zero());
    if (f < mesh_->n_interior) add(mesh_->neighbour[f], f, mesh_->shift(f));
  }
  return missed;
}

}  // namespace couplet::solid
