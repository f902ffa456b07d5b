// SPDX-License-Identifier: Apache-2.0

#include "solid_solver/thermal/thermal_strain.hpp"

#include <algorithm>
#include <cmath>

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

// Relative change of the elastic constants that is tolerated before the matrix is made anew.
constexpr double stiffness_tolerance = 1e-3;

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
    : mesh_(&mesh), elastic_(&elastic), parameters_(parameters) {
  if (parameters.heat) heat_ = make_heat(mesh, elastic.geometry(), parameters);
  if (parameters.temperature) prescribed_.emplace(*parameters.temperature, "temperature");
  for (const SolidMaterial& constants : materials_of(parameters)) {
    const HeatMaterial& tables = constants.heat;
    Material& m = materials_.emplace_back(Material{constants, {}, {}, {}});
    if (parameters.expansion) m.expansion = property(tables.expansion, "expansion", "'thermal-expansion'");
    if (tables.youngs_modulus) m.youngs_modulus.emplace(*tables.youngs_modulus, "youngs-modulus-table");
    if (tables.poissons_ratio) m.poissons_ratio.emplace(*tables.poissons_ratio, "poissons-ratio-table");
    lame_.varies = lame_.varies || m.youngs_modulus || m.poissons_ratio;
  }
  if (wants_stress()) dilation_.value.assign(mesh.cells.n_owned(), 0), dilation_.rate = dilation_.value;
  if (lame_.varies) lame_.accepted = lame_.trial = lame_at(cell_temperature(0, false));
  // Interface temperatures arrive later, see set_interface().
  start_ = is_given() ? std::vector<double>(mesh.n_flux_faces(), reference()) : face_temperature(0, false);
  seen_.first = *std::ranges::min_element(start_);
  seen_.second = *std::ranges::max_element(start_);
  set_accepted();
}

std::vector<double> ThermalStrain::cell_temperature(double t, bool trial) const {
  if (heat_) return trial ? heat_->trial().cells : heat_->accepted().cells;
  if (given_.from) return given_at(at_cells, trial);
  std::vector<double> values(mesh_->cells.n_local(), reference());
  if (is_given()) return values;  // set_interface() comes later
  prescribed_->evaluate(elastic_->geometry().cell_centre, t, values);
  return values;
}

std::vector<elastic::LameConstants> ThermalStrain::lame_at(std::span<const double> temperature) const {
  std::vector<elastic::LameConstants> result;
  for (Index c = 0; c < mesh_->cells.n_local(); ++c) {
    const Material& tables = materials_[mesh_->material_of(c)];
    SolidMaterial m = tables.constants;
    if (tables.youngs_modulus) m.youngs_modulus = (*tables.youngs_modulus)(temperature[c]);
    if (tables.poissons_ratio) m.poissons_ratio = (*tables.poissons_ratio)(temperature[c]);
    result.push_back(lame_constants(parameters_, m));
  }
  return result;
}

// Keeps the constants of the accepted step while they are accurate enough, because a new matrix costs more.
void ThermalStrain::choose_stiffness(double t) {
  lame_.trial = lame_at(cell_temperature(t, true));
  double change = 0;
  for (std::size_t c = 0; c < lame_.accepted.size(); ++c) {
    const double size = 2 * lame_.accepted[c].mu + std::abs(lame_.accepted[c].lambda);
    change = std::max({change, 2 * std::abs(lame_.trial[c].mu - lame_.accepted[c].mu) / size,
                       std::abs(lame_.trial[c].lambda - lame_.accepted[c].lambda) / size});
  }
  if (parallel::max(mesh_->comm, change) <= stiffness_tolerance) lame_.trial = lame_.accepted;
}

// Equal on all ranks, because new matrices are created collectively.
std::span<const elastic::LameConstants> ThermalStrain::stiffness() const {
  if (!lame_.varies) return {};
  bool differs = false;
  for (std::size_t c = 0; c < lame_.trial.size(); ++c) {
    const elastic::LameConstants now = elastic_->lame(static_cast<Index>(c));
    differs = differs || now.mu != lame_.trial[c].mu || now.lambda != lame_.trial[c].lambda;
  }
  return parallel::any(mesh_->comm, differs) ? std::span<const elastic::LameConstants>(lame_.trial)
                                             : std::span<const elastic::LameConstants>();
}

std::vector<double> ThermalStrain::face_temperature(double t, bool trial) const {
  if (heat_) return heat_->face_temperature(trial ? heat_->trial() : heat_->accepted());
  if (is_given()) return given_at(at_faces, trial);
  std::vector<double> values(mesh_->n_flux_faces());
  prescribed_->evaluate({elastic_->geometry().face_centre.data(), values.size()}, t, values);
  return values;
}

/// Before any value is given, the solid has its reference temperature.
std::vector<double> ThermalStrain::given_at(Places places, bool trial) const {
  const std::vector<double>& faces = trial ? given_.trial : given_.accepted;
  const FaceInterpolation& at = given_.from.value().at(places);
  std::vector<double> values(at.size(), reference());
  for (std::size_t i = 0; i < values.size() && !faces.empty(); ++i) values[i] = at.value(i, faces);
  return values;
}

void ThermalStrain::set_interface(const std::vector<Vec3>& face_centres, const std::vector<Index>& faces) {
  for (const Index f : faces) given_.faces.push_back(f - mesh_->n_interior);
  const mesh::Geometry& g = elastic_->geometry();
  const std::span flux_faces(g.face_centre.data(), std::size_t(mesh_->n_flux_faces()));
  given_.from.emplace(
      mesh_->comm, face_centres,
      std::vector<std::span<const Vec3>>{flux_faces, elastic_->geometry().points, g.cell_centre});
  start_ = face_temperature(0, false);
  set_accepted();
}

void ThermalStrain::take_temperature(const std::vector<double>& faces) {
  const std::vector<double> given = given_.from.value().with_others(faces);
  given_.trial = given.empty() ? given_.accepted : given;
}

void ThermalStrain::set_accepted() {
  if (!expands()) return;
  accepted_.strain = strain(start_);
  stiffness_changed();
}

void ThermalStrain::stiffness_changed() {
  if (expands()) accepted_.stress = stress_of(accepted_.strain);
}

void ThermalStrain::begin_step(const coupling::Step& step) {
  step_ = step;
  if (heat_) {
    std::vector<double> source(dilation_.rate.size());
    for (std::size_t c = 0; c < source.size(); ++c) {
      const double temperature = heat_->accepted().cells[c];
      const auto cell = static_cast<Index>(c);
      source[c] = -three_bulk(elastic_->lame(cell), is_plane_stress(parameters_)) *
                  (*materials_[mesh_->material_of(cell)].expansion)(temperature)*temperature *
                  dilation_.rate[c];
    }
    heat_->solve(step, source);
  }
  end_ = face_temperature(step.time + step.dt, true);
  if (lame_.varies) choose_stiffness(step.time + step.dt);
}

void ThermalStrain::add_loads(double t, const elastic::ElasticKernel& kernel, std::span<double> rhs) {
  if (expands()) kernel.add_pressure(pressure(t), rhs);
}

std::vector<double> ThermalStrain::expansion(double t) {
  if (!parameters_.expansion) return {};
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
  given_.accepted = given_.trial;
  time_ = step_.time + step_.dt;
  std::swap(start_, end_);
  lame_.accepted = lame_.trial;
  for (const double t : start_) {
    seen_.first = std::min(seen_.first, t);
    seen_.second = std::max(seen_.second, t);
  }
  set_accepted();
}

void ThermalStrain::visit(io::Archive& archive) {
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
  if (wants_stress()) {
    archive.field(mesh::Entries::owned_cells, "dilation", dilation_.value, 1);
    archive.field(mesh::Entries::owned_cells, "dilation-rate", dilation_.rate, 1);
  }
  if (lame_.varies) {
    std::vector<double> constants;
    for (const elastic::LameConstants& lame : lame_.accepted)
      constants.insert(constants.end(), {lame.mu, lame.lambda});
    archive.field(mesh::Entries::cells, "elastic-constants", constants, 2);
    for (std::size_t c = 0; c < lame_.accepted.size(); ++c)
      lame_.accepted[c] = {constants[2 * c], constants[2 * c + 1]};
  }
  seen_ = temperatures_seen();
  archive.common("temperatures", time_, seen_.first, seen_.second);
  if (!archive.reads()) return;
  if (lame_.varies) lame_.trial = lame_.accepted;
  start_ = face_temperature(time_, false);
  set_accepted();
}

std::pair<double, double> ThermalStrain::temperatures_seen() const {
  return {parallel::min(mesh_->comm, seen_.first), parallel::max(mesh_->comm, seen_.second)};
}

double ThermalStrain::modulus(Index cell) const {
  const elastic::LameConstants& lame = elastic_->lame(cell);
  return (is_plane_stress(parameters_) ? 2 : 3) * lame.lambda + 2 * lame.mu;
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
    result[f] =
        materials_[mesh_->material_of(mesh_->owner[f])].expansion->integral(reference(), temperature[f]);
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
    const auto [here, there] = elastic::pyramids(*mesh_, elastic_->geometry(), f);
    stress[f] += (here * of_cells[owner] + there * of_cells[neighbour]) / (here + there) -
                 0.5 * (bulk(owner) + bulk(neighbour)) * strain[f];
  }
  return stress;
}

void ThermalStrain::add_face_stress(Index first, std::span<Tensor3> stress) const {
  if (!expands()) return;
  for (std::size_t i = 0; i < stress.size(); ++i)
    stress[i].diagonal().array() -= accepted_.stress[std::size_t(first) + i];
}

std::vector<double> ThermalStrain::pyramid_means(const std::vector<double>& of_faces) const {
  const Index n_owned = mesh_->cells.n_owned();
  std::vector<double> total(n_owned, 0), weight(n_owned, 0);
  elastic::visit_pyramids(*mesh_, elastic_->geometry(), [&](Index c, Index f, double pyramid) {
    total[c] += pyramid * of_faces[f];
    weight[c] += pyramid;
  });
  for (Index c = 0; c < n_owned; ++c) total[c] /= weight[c];
  return total;
}

std::vector<double> ThermalStrain::cell_strain() const {
  if (!by_cells()) return pyramid_means(accepted_.strain);
  std::vector<double> result = pyramid_means(accepted_.stress);
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
        stress[c].trace() / three_bulk(elastic_->lame(static_cast<Index>(c)), is_plane_stress(parameters_)) +
        3 * strain[c];
    dilation_.rate[c] = (now - dilation_.value[c]) / step_.dt;
    dilation_.value[c] = now;
  }
}

/// (3 K alpha)^2 T/((lambda + 2 mu) rho c): relative stiffening by the coupling, largest over the materials.
double ThermalStrain::coupling_number() const {
  double most = 0;
  const double temperature = parallel::max(mesh_->comm, seen_.second);
  for (const auto& [m, expansion, young, poisson] : materials_) {
    if (!heat_ || !expansion || !m.heat.specific_heat) continue;
    const double e = m.youngs_modulus, nu = m.poissons_ratio;
    const double beta = e / (1 - 2 * nu) * (*expansion)(temperature);
    const double stiff = e * (1 - nu) / ((1 + nu) * (1 - 2 * nu));
    const double capacity =
        m.density * fv::Property(*m.heat.specific_heat, "material.specific-heat")(temperature);
    most = std::max(most, beta * beta * temperature / (stiff * capacity));
  }
  return most;
}

std::vector<double> ThermalStrain::point_temperature() const {
  if (heat_) return heat_->point_temperature(heat_->accepted());
  if (is_given()) return given_at(at_points, false);
  std::vector<double> values(mesh_->points.n_local());
  prescribed_->evaluate(elastic_->geometry().points, time_, values);
  return values;
}

}  // namespace couplet::solid
