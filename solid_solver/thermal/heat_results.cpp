// SPDX-License-Identifier: Apache-2.0

#include <fmt/format.h>

#include <algorithm>

#include "common/io/checkpoint.hpp"
#include "common/parallel/collective.hpp"
#include "solid_solver/thermal/heat.hpp"

namespace couplet::solid {

/// The known values as fields, zeros elsewhere: per local point, per boundary face of owned cells.
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

// What is made of the temperature: values at points and faces, heat through patches, what was neglected.

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

// Heat needs L^2 / a to get through a solid of half thickness L = volume / surface, a = k / (rho c).
void Heat::judge(std::vector<std::string>& sentences) const {
  if (!is_steady() || state_.steps < 2) return;
  const HeatProperties& m = materials_.front();
  double volume = 0, surface = 0, level = 0;
  for (Index c = 0; c < mesh_->cells.n_owned(); ++c) {
    volume += geometry_->volume[c];
    level += geometry_->volume[c] * state_.cells[c];
  }
  for (Index f = mesh_->n_interior; f < mesh_->n_flux_faces(); ++f)
    if (conduction_.condition(f) != fv::HeatCondition::symmetry &&
        conduction_.condition(f) != fv::HeatCondition::bonded)
      surface += geometry_->face_area[f].norm();
  volume = parallel::sum(mesh_->comm, volume);
  level = parallel::sum(mesh_->comm, level) / volume;
  const double size = volume / parallel::sum(mesh_->comm, surface);
  const double stored = m.density * m.specific_heat(level);
  if (!(stored > 0)) {
    sentences.push_back(
        "heat storage neglected (steady): give 'specific-heat' to compare its time scale with the step.");
    return;
  }
  const double time = size * size * stored / m.conductivity(level);
  sentences.push_back(
      fmt::format("heat storage neglected (steady): heat needs about {:.2g} s to spread through the solid, "
                  "a step takes {:.2g} s (Fourier number {:.2g}): {}.",
                  time, state_.dt, state_.dt / time,
                  state_.dt > 3 * time ? "justified"
                                       : "not justified if the loads change that fast; use 'analysis: "
                                         "transient'"));
}

}  // namespace couplet::solid
