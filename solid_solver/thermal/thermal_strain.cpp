// SPDX-License-Identifier: Apache-2.0
#include "solid_solver/thermal/thermal_strain.hpp"

#include <algorithm>
#include <cmath>

#include "common/base/error.hpp"
#include "common/io/checkpoint.hpp"
#include "common/parallel/collective.hpp"

namespace couplet::solid {
namespace {

std::vector<std::string> symmetry_patches(const SolidParameters& parameters) {
  std::vector<std::string> names;
  for (const auto& [name, boundary] : parameters.boundaries)
    if (is_symmetry_plane(boundary)) names.push_back(name);
  return names;
}

fv::Property property(const std::optional<config::ExpressionText>& text, const std::string& key,
                      const char* needed_by) {
  if (!text) throw Error("material.{}: this key is missing; {} requires it.", key, needed_by);
  return fv::Property(*text, "material." + key);
}

}  // namespace

std::unique_ptr<Heat> make_heat(const mesh::Mesh& mesh, const mesh::Geometry& geometry,
                                const SolidParameters& parameters) {
  const auto properties = [&](const SolidMaterial& material) {
    const HeatMaterial& m = material.heat;
    HeatProperties result{material.density, property(m.conductivity, "conductivity", "'heat'"), 0};
    if (m.specific_heat || parameters.heat->analysis == HeatParameters::Analysis::transient)
      result.specific_heat = property(m.specific_heat, "specific-heat", "a transient 'heat'");
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
  return std::make_unique<Heat>(mesh, geometry, std::move(of_zone), *parameters.heat,
                                symmetry_patches(parameters));
}

ThermalStrain::ThermalStrain(const mesh::Mesh& mesh, const elastic::ElasticOperator& elastic,
                             const SolidParameters& parameters)
    : mesh_(&mesh),
      geometry_(&elastic.geometry()),
      elastic_(&elastic),
      parameters_(parameters),
      materials_(materials_of(parameters)),
      coupled_(parameters.thermoelastic_coupling) {
  const mesh::Geometry& geometry = elastic.geometry();
  if (parameters.heat) heat_ = make_heat(mesh, geometry, parameters);
  given_ = parameters.interface_data && parameters.interface_data->temperature;
  if (parameters.temperature) prescribed_.emplace(*parameters.temperature, "temperature");
  if (parameters.expansion) {
    for (const SolidMaterial& material : materials_)
      expansion_.push_back(property(material.heat.expansion, "expansion", "'thermal-expansion'"));
    reference_ = parameters.expansion->reference_temperature;
  }
  for (const SolidMaterial& m : materials_) {
    youngs_modulus_.emplace_back();
    poissons_ratio_.emplace_back();
    if (m.heat.youngs_modulus) youngs_modulus_.back().emplace(*m.heat.youngs_modulus, "youngs-modulus-table");
    if (m.heat.poissons_ratio) poissons_ratio_.back().emplace(*m.heat.poissons_ratio, "poissons-ratio-table");
    varies_ = varies_ || m.heat.youngs_modulus || m.heat.poissons_ratio;
  }
  plane_stress_ = mesh.dim == 2 && parameters.plane == SolidParameters::Plane::stress;
  is_large_ = has_finite_strain(parameters);
  if (coupled_) dilation_.assign(mesh.cells.n_owned(), 0), dilation_rate_ = dilation_;
  if (varies_) lame_ = lame_trial_ = lame_at(cell_temperature(0, false));
  // Interface temperatures arrive later, see set_interface().
  start_ = given_ ? std::vector<double>(mesh.n_flux_faces(), reference_) : face_temperature(0, false);
  lowest_ = *std::ranges::min_element(start_);
  highest_ = *std::ranges::max_element(start_);
  set_accepted();
}

std::vector<double> ThermalStrain::cell_temperature(double t, bool trial) const {
  if (heat_) return trial ? heat_->trial().cells : heat_->accepted().cells;
  if (interface_) return given_at(at_cells, trial);
  std::vector<double> values(mesh_->cells.n_local(), reference_);
  if (given_) return values;  // set_interface() comes later
  prescribed_->evaluate(geometry_->cell_centre, t, values);
  return values;
}

std::vector<elastic::LameConstants> ThermalStrain::lame_at(std::span<const double> temperature) const {
  std::vector<elastic::LameConstants> result;
  for (Index c = 0; c < mesh_->cells.n_local(); ++c) {
    const int i = mesh_->material_of(c);
    SolidMaterial m = materials_[i];
    if (youngs_modulus_[i]) m.youngs_modulus = (*youngs_modulus_[i])(temperature[c]);
    if (poissons_ratio_[i]) m.poissons_ratio = (*poissons_ratio_[i])(temperature[c]);
    result.push_back(lame_constants(parameters_, m));
  }
  return result;
}

// Keeps the constants of the accepted step while they are accurate enough, because a new matrix costs more.
void ThermalStrain::choose_stiffness(double t) {
  lame_trial_ = lame_at(cell_temperature(t, true));
  double change = 0;
  for (std::size_t c = 0; c < lame_.size(); ++c) {
    const double size = 2 * lame_[c].mu + std::abs(lame_[c].lambda);
    change = std::max({change, 2 * std::abs(lame_trial_[c].mu - lame_[c].mu) / size,
                       std::abs(lame_trial_[c].lambda - lame_[c].lambda) / size});
  }
  if (parallel::max(mesh_->comm, change) <= parameters_.stiffness_tolerance) lame_trial_ = lame_;
}

// Equal on all ranks, because new matrices are created collectively.
std::span<const elastic::LameConstants> ThermalStrain::stiffness() const {
  if (!varies_) return {};
  bool differs = false;
  for (std::size_t c = 0; c < lame_trial_.size(); ++c) {
    const elastic::LameConstants now = elastic_->lame(static_cast<Index>(c));
    differs = differs || now.mu != lame_trial_[c].mu || now.lambda != lame_trial_[c].lambda;
  }
  return parallel::any(mesh_->comm, differs) ? std::span<const elastic::LameConstants>(lame_trial_)
                                             : std::span<const elastic::LameConstants>();
}

std::vector<double> ThermalStrain::face_temperature(double t, bool trial) const {
  if (heat_) return heat_->face_temperature(trial ? heat_->trial() : heat_->accepted());
  if (given_) return given_at(at_faces, trial);
  std::vector<double> values(mesh_->n_flux_faces());
  prescribed_->evaluate({geometry_->face_centre.data(), values.size()}, t, values);
  return values;
}

/// Before any value is given, the solid has its reference temperature.
std::vector<double> ThermalStrain::given_at(Places places, bool trial) const {
  const std::vector<double>& faces = trial ? given_trial_ : given_accepted_;
  const FaceInterpolation& at = interface_.value().at(places);
  std::vector<double> values(at.size(), reference_);
  for (std::size_t i = 0; i < values.size() && !faces.empty(); ++i) values[i] = at.value(i, faces);
  return values;
}

void ThermalStrain::set_interface(const std::vector<Vec3>& face_centres, const std::vector<Index>& faces) {
  for (const Index f : faces) interface_faces_.push_back(f - mesh_->n_interior);
  const auto& g = *geometry_;
  const std::span flux_faces(g.face_centre.data(), std::size_t(mesh_->n_flux_faces()));
  interface_.emplace(mesh_->comm, face_centres,
                     std::vector<std::span<const Vec3>>{flux_faces, geometry_->points, g.cell_centre});
  start_ = face_temperature(0, false);
  set_accepted();
}

void ThermalStrain::take_temperature(const std::vector<double>& faces) {
  const std::vector<double> given = interface_.value().with_others(faces);
  given_trial_ = given.empty() ? given_accepted_ : given;
}

void ThermalStrain::set_accepted() {
  if (!expands()) return;
  accepted_strain_ = strain(start_);
  stiffness_changed();
}

void ThermalStrain::stiffness_changed() {
  if (expands() && by_cells()) accepted_stress_ = stress_of(accepted_strain_);
}

void ThermalStrain::begin_step(const coupling::Step& step) {
  step_ = step;
  if (heat_) {
    std::vector<double> source(dilation_rate_.size());
    for (std::size_t c = 0; c < source.size(); ++c) {
      const double temperature = heat_->accepted().cells[c];
      const auto cell = static_cast<Index>(c);
      source[c] = -three_bulk(elastic_->lame(cell), plane_stress_) *
                  expansion_[mesh_->material_of(cell)](temperature) * temperature * dilation_rate_[c];
    }
    heat_->solve(step, source);
  }
  end_ = face_temperature(step.time + step.dt, true);
  if (varies_) choose_stiffness(step.time + step.dt);
}

void ThermalStrain::add_loads(double t, const elastic::ElasticKernel& kernel, std::span<double> rhs) {
  if (expands()) kernel.add_pressure(pressure(t), rhs);
}

std::vector<double> ThermalStrain::expansion(double t) {
  if (expansion_.empty()) return {};
  if (prescribed_) return strain(face_temperature(t, true));
  // After the step is accepted, `start_` is its end.
  const double part = t > time_ ? (t - step_.time) / step_.dt : 0;
  std::vector<double> temperature = start_;
  if (part > 0)
    for (std::size_t f = 0; f < temperature.size(); ++f) temperature[f] += part * (end_[f] - start_[f]);
  return strain(temperature);
}

std::vector<double> ThermalStrain::pressure(double t) {
  if (!expands()) return {};
  std::vector<double> pressure = stress_of(expansion(t));
  pressure.resize(mesh_->n_faces());
  mesh_->boundary.update_ghosts(std::span(pressure).subspan(mesh_->n_interior));
  return pressure;
}

void ThermalStrain::accept_step() {
  if (heat_) heat_->accept_step();
  given_accepted_ = given_trial_;
  time_ = step_.time + step_.dt;
  std::swap(start_, end_);
  lame_ = lame_trial_;
  for (const double t : start_) {
    lowest_ = std::min(lowest_, t);
    highest_ = std::max(highest_, t);
  }
  set_accepted();
}

void ThermalStrain::save(io::CheckpointWriter& file) const {
  if (heat_) heat_->save(file);
  if (given_) {
    const bool is_given = parallel::any(mesh_->comm, !given_accepted_.empty());
    std::vector<double> faces(is_given ? std::size_t(mesh_->boundary.n_owned()) : 0);
    for (std::size_t i = 0; is_given && i < interface_faces_.size(); ++i)
      faces[interface_faces_[i]] = given_accepted_[i];
    file.write(mesh::Entries::owned_boundary, "interface-temperature", faces);
  }
  if (coupled_) {
    file.write(mesh::Entries::owned_cells, "dilation", dilation_);
    file.write(mesh::Entries::owned_cells, "dilation-rate", dilation_rate_);
  }
  std::vector<double> constants;
  for (const elastic::LameConstants& lame : lame_) constants.insert(constants.end(), {lame.mu, lame.lambda});
  if (varies_) file.write(mesh::Entries::cells, "elastic-constants", constants);
  file.write_scalar("temperature-time", time_);
  file.write_scalar("lowest-temperature", parallel::min(mesh_->comm, lowest_));
  file.write_scalar("highest-temperature", parallel::max(mesh_->comm, highest_));
}

void ThermalStrain::load(io::CheckpointReader& file) {
  if (heat_) heat_->load(file);
  if (given_) {
    const std::vector<double> saved =
        file.read_or_none(mesh::Entries::owned_boundary, "interface-temperature", 1);
    std::vector<double> faces;
    for (const Index f : interface_faces_)
      if (!saved.empty()) faces.push_back(saved[f]);
    if (interface_) given_trial_ = given_accepted_ = interface_->with_others(faces);
  }
  if (coupled_) {
    file.read(mesh::Entries::owned_cells, "dilation", dilation_);
    file.read(mesh::Entries::owned_cells, "dilation-rate", dilation_rate_);
  }
  if (varies_) {
    std::vector<double> constants(2 * lame_.size());
    file.read(mesh::Entries::cells, "elastic-constants", constants);
    for (std::size_t c = 0; c < lame_.size(); ++c) lame_[c] = {constants[2 * c], constants[2 * c + 1]};
    lame_trial_ = lame_;
  }
  time_ = file.read_scalar("temperature-time");
  lowest_ = file.read_scalar("lowest-temperature");
  highest_ = file.read_scalar("highest-temperature");
  start_ = face_temperature(time_, false);
  set_accepted();
}

std::pair<double, double> ThermalStrain::temperatures_seen() const {
  return {parallel::min(mesh_->comm, lowest_), parallel::max(mesh_->comm, highest_)};
}

}  // namespace couplet::solid
