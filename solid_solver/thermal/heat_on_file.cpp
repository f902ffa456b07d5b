// SPDX-License-Identifier: Apache-2.0
#include "common/io/checkpoint.hpp"
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

}  // namespace couplet::solid
