// SPDX-License-Identifier: Apache-2.0
#include "solid_solver/body/solid_interface.hpp"

#include "common/base/error.hpp"

namespace couplet::solid {

SolidInterface::SolidInterface(const SolidBody& body) : body_(body) {
  const mesh::Mesh& mesh = body.mesh();
  const SolidParameters& parameters = body.parameters();
  if (!body.boundaries().interface_patches().empty()) {
    map_ = std::make_unique<coupling::InterfaceMap>(mesh, body.boundaries().interface_patches());
    description_ = map_->describe(body.geometry());
  }
  description_.dim = mesh.dim;
  description_.takes = taken(parameters.interface_data.value_or(InterfaceData{}));
  description_.gives = {{"displacement", "m", coupling::Interface::Place::vertices},
                        {"velocity", "m/s", coupling::Interface::Place::vertices}};
  if (!parameters.interface_data || !parameters.interface_data->temperature) return;
  if (!map_)
    throw Error(
        "interface: no patch has 'type: interface', so there is no face that could receive a temperature.");
  takes_temperature_ = true;
  body.temperature()->set_interface(description_.face_centres, map_->faces());
}

void SolidInterface::take_temperature(const coupling::Exchange& in) const {
  const auto found = in.find("temperature");
  const std::vector<double> faces = found == in.end() ? std::vector<double>{} : found->second;
  body_.temperature()->take(faces);
}

std::vector<double> SolidInterface::load(const coupling::Exchange& in) const {
  if (!map_) return {};
  const mesh::Mesh& mesh = body_.mesh();
  const int dim = mesh.dim;
  std::vector<double> total(description_.face_centres.size() * dim, 0.0);
  for (const auto& [name, values] : in) {
    if (name == "temperature" && takes_temperature_) continue;
    if (std::ranges::none_of(description_.takes, [&](const auto& datum) { return datum.name == name; }))
      throw Error("The solid received '{}', which it does not accept.", name);
    if (name == "pressure" && values.size() * dim == total.size()) {
      // A normal force on each face; the areas point out of the solid.
      for (std::size_t i = 0; i < values.size(); ++i)
        for (int a = 0; a < dim; ++a) total[i * dim + a] -= values[i] * description_.face_areas[i][a];
      continue;
    }
    if (values.size() != total.size())
      throw Error("The solid received {} values of '{}', but its interface has {} faces of {} components.",
                  values.size(), name, description_.face_centres.size(), dim);
    for (std::size_t i = 0; i < values.size(); ++i) total[i] += values[i];
  }
  std::vector<double> force(std::size_t(mesh.boundary.n_owned()) * dim, 0);
  const std::vector<double> local = map_->scatter_faces(total, dim);
  for (std::size_t i = 0; i < map_->faces().size(); ++i)
    for (int a = 0; a < dim; ++a)
      force[std::size_t(map_->faces()[i] - mesh.n_interior) * dim + a] += local[i * dim + a];
  return force;
}

coupling::Exchange SolidInterface::values(const SolidState& state) const {
  if (!map_) return {};
  const int dim = body_.mesh().dim;
  coupling::Exchange out;
  out["displacement"] =
      map_->gather_vertices(body_.at_points(map_->points(), state.cell_u, state.face_u, state.known), dim);
  out["velocity"] = map_->gather_vertices(
      body_.at_points(map_->points(), state.cell_v, state.face_v, state.known_rate), dim);
  return out;
}

}  // namespace couplet::solid
