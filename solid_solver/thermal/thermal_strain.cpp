// SPDX-License-Identifier: Apache-2.0

#include "solid_solver/thermal/thermal_strain.hpp"

#include <algorithm>
#include <cmath>
#include <tuple>

#include "common/base/error.hpp"
#include "common/elasticity/symmetric/symmetric_faces.hpp"
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

void ThermalStrain::visit(io::Archive& archive) {
  if (heat_) heat_->visit(archive);
  if (given_) {
    const bool is_given = parallel::any(mesh_->comm, !given_accepted_.empty());
    std::vector<double> faces(is_given ? std::size_t(mesh_->boundary.n_owned()) : 0);
    for (std::size_t i = 0; is_given && i < interface_faces_.size(); ++i)
      faces[interface_faces_[i]] = given_accepted_[i];
    archive.field(mesh::Entries::owned_boundary, "interface-temperature", faces, 1);
    std::vector<double> here;
    for (const Index f : interface_faces_)
      if (!faces.empty()) here.push_back(faces[f]);
    if (interface_ && archive.reads()) given_trial_ = given_accepted_ = interface_->with_others(here);
  }
  if (coupled_) {
    archive.field(mesh::Entries::owned_cells, "dilation", dilation_, 1);
    archive.field(mesh::Entries::owned_cells, "dilation-rate", dilation_rate_, 1);
  }
  if (varies_) {
    std::vector<double> constants;
    for (const elastic::LameConstants& lame : lame_)
      constants.insert(constants.end(), {lame.mu, lame.lambda});
    archive.field(mesh::Entries::cells, "elastic-constants", constants, 2);
    for (std::size_t c = 0; c < lame_.size(); ++c) lame_[c] = {constants[2 * c], constants[2 * c + 1]};
  }
  std::tie(lowest_, highest_) = temperatures_seen();
  archive.common("temperatures", time_, lowest_, highest_);
  if (!archive.reads()) return;
  if (varies_) lame_trial_ = lame_;
  start_ = face_temperature(time_, false);
  set_accepted();
}

std::pair<double, double> ThermalStrain::temperatures_seen() const {
  return {parallel::min(mesh_->comm, lowest_), parallel::max(mesh_->comm, highest_)};
}

double ThermalStrain::modulus(Index cell) const {
  const elastic::LameConstants& lame = elastic_->lame(cell);
  return (plane_stress_ ? 2 : 3) * lame.lambda + 2 * lame.mu;
}

// Constants as in the operator: mean within a material.
double ThermalStrain::face_modulus(Index face) const {
  const double here = modulus(mesh_->owner[face]);
  return face < mesh_->n_interior ? 0.5 * (here + modulus(mesh_->neighbour[face])) : here;
}

double three_bulk(elastic::LameConstants lame, bool plane_stress) {
  if (plane_stress) lame.lambda = 2 * lame.lambda * lame.mu / (2 * lame.mu - lame.lambda);  // the true one
  return 3 * lame.lambda + 2 * lame.mu;
}

std::vector<double> ThermalStrain::strain(std::span<const double> temperature) const {
  std::vector<double> result(temperature.size());
  for (std::size_t f = 0; f < temperature.size(); ++f)
    result[f] = expansion_[mesh_->material_of(mesh_->owner[f])].integral(reference_, temperature[f]);
  return result;
}

std::vector<double> ThermalStrain::stress_of(const std::vector<double>& strain) const {
  std::vector<double> stress = strain;
  for (std::size_t f = 0; f < stress.size(); ++f) stress[f] *= face_modulus(static_cast<Index>(f));
  if (!by_cells()) return stress;
  std::vector<double> of_cells = pyramid_means(strain);
  of_cells.resize(std::size_t(mesh_->cells.n_local()));
  const auto bulk = [&](Index c) {
    return 3 * elastic::bulk_of_cells(elastic_->lame(c), elastic_->volume_strain());
  };
  for (Index c = 0; c < mesh_->cells.n_owned(); ++c) of_cells[c] *= bulk(c);
  mesh_->cells.update_ghosts(of_cells);
  for (Index f = 0; f < std::ssize(stress); ++f) {
    const Index owner = mesh_->owner[f];
    if (f >= mesh_->n_interior) {
      stress[f] += of_cells[owner] - bulk(owner) * strain[f];
      continue;
    }
    const Index neighbour = mesh_->neighbour[f];
    const auto [here, there] = elastic::pyramids(*mesh_, *geometry_, f);
    stress[f] += (here * of_cells[owner] + there * of_cells[neighbour]) / (here + there) -
                 0.5 * (bulk(owner) + bulk(neighbour)) * strain[f];
  }
  return stress;
}

void ThermalStrain::add_face_stress(Index first, std::span<Tensor3> stress) const {
  if (!expands()) return;
  for (std::size_t i = 0; i < stress.size(); ++i) {
    const Index f = first + static_cast<Index>(i);
    stress[i].diagonal().array() -= by_cells() ? accepted_stress_[f] : face_modulus(f) * accepted_strain_[f];
  }
}

std::vector<double> ThermalStrain::pyramid_means(const std::vector<double>& of_faces) const {
  const Index n_owned = mesh_->cells.n_owned();
  std::vector<double> total(n_owned, 0), weight(n_owned, 0);
  elastic::visit_pyramids(*mesh_, *geometry_, [&](Index c, Index f, double pyramid) {
    total[c] += pyramid * of_faces[f];
    weight[c] += pyramid;
  });
  for (Index c = 0; c < n_owned; ++c) total[c] /= weight[c];
  return total;
}

std::vector<double> ThermalStrain::cell_strain() const {
  if (!by_cells()) return pyramid_means(accepted_strain_);
  std::vector<double> result = pyramid_means(accepted_stress_);
  for (std::size_t c = 0; c < result.size(); ++c) result[c] /= modulus(static_cast<Index>(c));
  return result;
}

void ThermalStrain::add_cell_stress(std::span<Tensor3> stress) const {
  if (!expands()) return;
  const std::vector<double> strain = cell_strain();
  for (Index c = 0; c < std::ssize(strain); ++c) stress[c].diagonal().array() -= modulus(c) * strain[c];
}

// tr(sigma) = 3 K [tr(eps) - 3 epsilon], also in plane strain and plane stress.
void ThermalStrain::take_stress(std::span<const Tensor3> stress) {
  const std::vector<double> strain = cell_strain();
  for (std::size_t c = 0; c < stress.size(); ++c) {
    const double now =
        stress[c].trace() / three_bulk(elastic_->lame(static_cast<Index>(c)), plane_stress_) + 3 * strain[c];
    dilation_rate_[c] = (now - dilation_[c]) / step_.dt;
    dilation_[c] = now;
  }
}

/// (3 K alpha)^2 T/((lambda + 2 mu) rho c): relative stiffening by the coupling, largest over the materials.
double ThermalStrain::coupling_number() const {
  double most = 0;
  const double temperature = parallel::max(mesh_->comm, highest_);
  for (std::size_t i = 0; heat_ && !expansion_.empty() && i < materials_.size(); ++i) {
    const SolidMaterial& m = materials_[i];
    if (!m.heat.specific_heat) continue;
    const double e = m.youngs_modulus, nu = m.poissons_ratio;
    const double beta = e / (1 - 2 * nu) * expansion_[i](temperature);
    const double stiff = e * (1 - nu) / ((1 + nu) * (1 - 2 * nu));
    const double capacity =
        m.density * fv::Property(*m.heat.specific_heat, "material.specific-heat")(temperature);
    most = std::max(most, beta * beta * temperature / (stiff * capacity));
  }
  return most;
}

// Temperature fields in files.

std::vector<double> ThermalStrain::point_temperature() const {
  if (heat_) return heat_->point_temperature(heat_->accepted());
  if (given_) return given_at(at_points, false);
  std::vector<double> values(mesh_->points.n_local());
  prescribed_->evaluate(geometry_->points, time_, values);
  return values;
}

void ThermalStrain::add_fields(std::vector<io::OutputField>& fields) {
  points_ = point_temperature();
  if (heat_) {
    cells_ = heat_->accepted().cells;
  } else if (given_) {
    cells_ = given_at(at_cells, false);
  } else {
    cells_.resize(mesh_->cells.n_local());
    prescribed_->evaluate(geometry_->cell_centre, time_, cells_);
  }
  fields.push_back({"temperature", "K", io::OutputField::Place::points, 1, points_});
  fields.push_back({"cell-temperature", "K", io::OutputField::Place::cells, 1, cells_});
}

void ThermalStrain::add_surface_fields(std::vector<io::OutputField>& fields) {
  points_ = point_temperature();
  fields.push_back({"temperature", "K", io::OutputField::Place::points, 1, points_});
  if (!heat_) return;
  inflow_ = heat_->boundary_inflow();
  fields.push_back({"heat-flux", "W/m^2", io::OutputField::Place::cells, 1, inflow_});
}

}  // namespace couplet::solid
