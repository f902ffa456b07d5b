// SPDX-License-Identifier: Apache-2.0
#include "solid_solver/body/solid_interface.hpp"

#include "common/base/error.hpp"

namespace couplet::solid {

HeatInterface::HeatInterface(Heat& heat, const coupling::InterfaceMap& map) : heat_(heat), map_(map) {
  heat_.set_interface(map.faces());
}

void HeatInterface::describe(coupling::Interface& description) {
  using Place = coupling::Interface::Place;
  description.takes.push_back({"heat", "W", Place::faces, 1});
  description.gives.push_back({"film-coefficient", "W/(m^2 K)", Place::faces, 1});
  description.gives.push_back({"ambient-temperature", "K", Place::faces, 1});
}

void HeatInterface::take(const coupling::Exchange& in) const {
  const auto found = in.find("heat");
  heat_.take(map_.scatter_faces(found == in.end() ? std::vector<double>{} : found->second, 1));
}

void HeatInterface::add_film(coupling::Exchange& out) const {
  const InterfaceFilm film = heat_.film();
  out["film-coefficient"] = map_.gather_faces(film.coefficient, 1);
  out["ambient-temperature"] = map_.gather_faces(film.ambient, 1);
}

SolidInterface::SolidInterface(const SolidBody& body) : body_(body) {
  const mesh::Mesh& mesh = body.mesh();
  const SolidParameters& parameters = body.parameters();
  Heat* heat = body.temperature() ? body.temperature()->heat() : nullptr;
  const bool conducts = heat && !heat->boundaries().interface_patches().empty();
  is_loaded_ = !body.boundaries().interface_patches().empty();
  if (is_loaded_ || conducts) {
    map_ = std::make_unique<coupling::InterfaceMap>(
        mesh, is_loaded_ ? body.boundaries().interface_patches() : heat->boundaries().interface_patches());
    description_ = map_->describe(body.geometry());
  }
  description_.dim = mesh.dim;
  if (conducts) HeatInterface::describe(description_), heat_.emplace(*heat, *map_);
  if (conducts && !is_loaded_) return;
  for (const auto& datum : taken(parameters.interface_data.value_or(InterfaceData{})))
    description_.takes.push_back(datum);
  description_.gives.push_back({"displacement", "m", coupling::Interface::Place::vertices});
  description_.gives.push_back({"velocity", "m/s", coupling::Interface::Place::vertices});
  if (!parameters.interface_data || !parameters.interface_data->temperature) return;
  if (!map_)
    throw Error(
        "interface: no patch has 'type: interface', so there is no face that could receive a temperature.");
  takes_temperature_ = true;
  body.temperature()->set_interface(description_.face_centres, map_->faces());
}

void SolidInterface::take_heating(const coupling::Exchange& in) const {
  if (heat_) return heat_->take(in);
  const auto found = in.find("temperature");
  const std::vector<double> faces = found == in.end() ? std::vector<double>{} : found->second;
  body_.temperature()->take(faces);
}

std::vector<double> SolidInterface::load(const coupling::Exchange& in) const {
  if (!is_loaded_) return {};
  const mesh::Mesh& mesh = body_.mesh();
  const int dim = mesh.dim;
  std::vector<double> total(description_.face_centres.size() * dim, 0.0);
  for (const auto& [name, values] : in) {
    if ((name == "temperature" && takes_temperature_) || (name == "heat" && heat_)) continue;
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
  if (heat_) heat_->add_film(out);
  if (!is_loaded_) return out;
  out["displacement"] =
      map_->gather_vertices(body_.at_points(map_->points(), state.cell_u, state.face_u, state.known), dim);
  out["velocity"] = map_->gather_vertices(
      body_.at_points(map_->points(), state.cell_v, state.face_v, state.known_rate), dim);
  return out;
}

}  // namespace couplet::solid
