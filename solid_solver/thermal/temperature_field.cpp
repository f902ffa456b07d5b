// SPDX-License-Identifier: Apache-2.0
#include "solid_solver/thermal/temperature_field.hpp"

#include <algorithm>

#include "common/base/error.hpp"
#include "common/io/checkpoint.hpp"
#include "common/parallel/collective.hpp"

namespace couplet::solid {

fv::Property material_property(const std::optional<config::ExpressionText>& text, const std::string& key,
                               const char* needed_by) {
  if (!text) throw Error("material.{}: this key is missing; {} requires it.", key, needed_by);
  return fv::Property(*text, "material." + key);
}

std::unique_ptr<Heat> make_heat(const mesh::Mesh& mesh, const mesh::Geometry& geometry,
                                const SolidParameters& parameters) {
  const auto properties = [&](const SolidMaterial& material) {
    const HeatMaterial& m = material.heat;
    HeatProperties result{material.density, material_property(m.conductivity, "conductivity", "'heat'"), 0};
    if (m.specific_heat || parameters.heat->analysis == HeatParameters::Analysis::transient)
      result.specific_heat = material_property(m.specific_heat, "specific-heat", "a transient 'heat'");
    return result;
  };
  const std::vector<SolidMaterial> materials = materials_of(parameters);
  const auto zones = zones_of(parameters.materials);
  std::vector<HeatProperties> of_zone;
  for (const std::string& zone : mesh.zones) {
    std::size_t i = 0;
    while (i + 1 < zones.size() && std::ranges::find(zones[i], zone) == zones[i].end()) ++i;
    of_zone.push_back(properties(materials[i]));
  }
  std::vector<std::string> symmetry_patches;
  for (const auto& [name, boundary] : parameters.boundaries)
    if (is_symmetry_plane(boundary)) symmetry_patches.push_back(name);
  return std::make_unique<Heat>(mesh, geometry, std::move(of_zone), *parameters.heat, symmetry_patches);
}

TemperatureField::TemperatureField(const mesh::Mesh& mesh, const mesh::Geometry& geometry,
                                   const SolidParameters& parameters)
    : mesh_(&mesh),
      places_{std::span(geometry.face_centre).first(mesh.n_flux_faces()), geometry.points,
              geometry.cell_centre},
      parameters_(parameters) {
  if (parameters.heat) heat_ = make_heat(mesh, geometry, parameters);
  if (parameters.temperature) prescribed_.emplace(*parameters.temperature, "temperature");
  start_ = at(faces, 0, false);
  seen_ = {*std::ranges::min_element(start_), *std::ranges::max_element(start_)};
}

std::vector<double> TemperatureField::at(Places places, double t, bool trial) const {
  if (heat_) {
    const HeatState& state = trial ? heat_->trial() : heat_->accepted();
    if (places == cells) return state.cells;
    return places == faces ? heat_->face_temperature(state) : heat_->point_temperature(state);
  }
  std::vector<double> values(places_[places].size(), reference());
  if (!is_given()) prescribed_->evaluate(places_[places], t, values);
  const std::vector<double>& given = trial ? given_.trial : given_.accepted;
  for (std::size_t i = 0; i < values.size() && !given.empty(); ++i)
    values[i] = given_.from.value().at(places).value(i, given);
  return values;
}

std::vector<double> TemperatureField::of_faces(double t) const {
  if (prescribed_) return at(faces, t, true);
  // After the step is accepted, `start_` is its end.
  const double part = t > time_ ? (t - step_.time) / step_.dt : 0;
  std::vector<double> temperature = start_;
  if (part > 0)
    for (std::size_t f = 0; f < temperature.size(); ++f) temperature[f] += part * (end_[f] - start_[f]);
  return temperature;
}

void TemperatureField::set_interface(const std::vector<Vec3>& face_centres, const std::vector<Index>& faces) {
  for (const Index f : faces) given_.faces.push_back(f - mesh_->n_interior);
  given_.from.emplace(mesh_->comm, face_centres, std::vector(places_.begin(), places_.end()));
}

void TemperatureField::take(const std::vector<double>& faces) {
  const std::vector<double> given = given_.from.value().with_others(faces);
  given_.trial = given.empty() ? given_.accepted : given;
}

void TemperatureField::solve(const coupling::Step& step, std::span<const double> source) {
  step_ = step;
  if (heat_) heat_->solve(step, source);
  end_ = at(faces, step.time + step.dt, true);
}

void TemperatureField::accept_step() {
  if (heat_) heat_->accept_step();
  given_.accepted = given_.trial;
  time_ = step_.time + step_.dt;
  std::swap(start_, end_);
  for (const double t : start_) {
    seen_.first = std::min(seen_.first, t);
    seen_.second = std::max(seen_.second, t);
  }
}

void TemperatureField::visit(io::Archive& archive) {
  if (heat_) heat_->visit(archive);
  if (is_given()) {
    const bool any_given = parallel::any(mesh_->comm, !given_.accepted.empty());
    std::vector<double> faces(any_given ? std::size_t(mesh_->boundary.n_owned()) : 0);
    for (std::size_t i = 0; any_given && i < given_.faces.size(); ++i)
      faces[given_.faces[i]] = given_.accepted[i];
    archive.field(mesh::Entries::owned_boundary, "interface-temperature", faces, 1);
    std::vector<double> here;
    for (const Index f : given_.faces)
      if (!faces.empty()) here.push_back(faces[f]);
    if (given_.from && archive.reads()) given_.trial = given_.accepted = given_.from->with_others(here);
  }
  seen_ = seen();
  archive.common("temperatures", time_, seen_.first, seen_.second);
  if (archive.reads()) start_ = at(Places::faces, time_, false);
}

std::pair<double, double> TemperatureField::seen() const {
  return {parallel::min(mesh_->comm, seen_.first), parallel::max(mesh_->comm, seen_.second)};
}

}  // namespace couplet::solid
