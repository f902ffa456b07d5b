// SPDX-License-Identifier: Apache-2.0

#include "solid_solver/thermal/thermal_load.hpp"

#include <algorithm>
#include <cmath>

#include "common/base/error.hpp"
#include "common/elasticity/symmetric/symmetric_faces.hpp"
#include "common/io/checkpoint.hpp"
#include "common/parallel/collective.hpp"

namespace couplet::solid {
namespace {

// Relative change of the elastic constants that is tolerated before the matrix is made anew.
constexpr double stiffness_tolerance = 1e-3;

}  // namespace

ThermalLoad::ThermalLoad(const mesh::Mesh& mesh, const elastic::ElasticOperator& elastic,
                         const SolidParameters& parameters)
    : mesh_(&mesh),
      elastic_(&elastic),
      parameters_(parameters),
      temperature_(mesh, elastic.geometry(), parameters) {
  for (const SolidMaterial& constants : materials_of(parameters)) {
    const HeatMaterial& tables = constants.heat;
    Material& m = materials_.emplace_back(Material{constants, {}, {}, {}});
    if (parameters.expansion)
      m.expansion = material_property(tables.expansion, "expansion", "'thermal-expansion'");
    if (tables.youngs_modulus) m.youngs_modulus.emplace(*tables.youngs_modulus, "youngs-modulus-table");
    if (tables.poissons_ratio) m.poissons_ratio.emplace(*tables.poissons_ratio, "poissons-ratio-table");
    lame_.varies = lame_.varies || m.youngs_modulus || m.poissons_ratio;
  }
  if (wants_stress()) dilation_.value.assign(mesh.cells.n_owned(), 0), dilation_.rate = dilation_.value;
  if (lame_.varies) lame_.accepted = lame_.trial = lame_at(temperature_.of_cells());
  set_accepted();
}

std::vector<elastic::LameConstants> ThermalLoad::lame_at(std::span<const double> temperature) const {
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
void ThermalLoad::choose_stiffness() {
  lame_.trial = lame_at(temperature_.trial_of_cells());
  double change = 0;
  for (std::size_t c = 0; c < lame_.accepted.size(); ++c) {
    const double size = 2 * lame_.accepted[c].mu + std::abs(lame_.accepted[c].lambda);
    change = std::max({change, 2 * std::abs(lame_.trial[c].mu - lame_.accepted[c].mu) / size,
                       std::abs(lame_.trial[c].lambda - lame_.accepted[c].lambda) / size});
  }
  if (parallel::max(mesh_->comm, change) <= stiffness_tolerance) lame_.trial = lame_.accepted;
}

// Equal on all ranks, because new matrices are created collectively.
std::span<const elastic::LameConstants> ThermalLoad::stiffness() const {
  if (!lame_.varies) return {};
  bool differs = false;
  for (std::size_t c = 0; c < lame_.trial.size(); ++c) {
    const elastic::LameConstants now = elastic_->lame(static_cast<Index>(c));
    differs = differs || now.mu != lame_.trial[c].mu || now.lambda != lame_.trial[c].lambda;
  }
  return parallel::any(mesh_->comm, differs) ? std::span<const elastic::LameConstants>(lame_.trial)
                                             : std::span<const elastic::LameConstants>();
}

void ThermalLoad::set_accepted() {
  if (!expands()) return;
  accepted_.strain = strain(temperature_.of_faces());
  stiffness_changed();
}

void ThermalLoad::stiffness_changed() {
  if (expands()) accepted_.stress = stress_of(accepted_.strain);
}

void ThermalLoad::begin_step(const coupling::Step& step) {
  dt_ = step.dt;
  std::vector<double> source(temperature_.heat() ? dilation_.rate.size() : 0);
  for (std::size_t c = 0; c < source.size(); ++c) {
    const double temperature = temperature_.heat()->accepted().cells[c];
    const auto cell = static_cast<Index>(c);
    source[c] = -three_bulk(cell) *
                (*materials_[mesh_->material_of(cell)].expansion)(temperature)*temperature *
                dilation_.rate[c];
  }
  temperature_.solve(step, source);
  if (lame_.varies) choose_stiffness();
}

void ThermalLoad::add_loads(double t, const elastic::ElasticKernel& kernel, std::span<double> rhs) const {
  if (expands()) kernel.add_pressure(pressure(t), rhs);
}

std::vector<double> ThermalLoad::expansion(double t) const {
  return parameters_.expansion ? strain(temperature_.of_faces(t)) : std::vector<double>{};
}

std::vector<double> ThermalLoad::pressure(double t) const {
  if (!expands()) return {};
  std::vector<double> pressure = stress_of(expansion(t));
  pressure.resize(mesh_->n_faces());
  mesh_->boundary.update_ghosts(std::span(pressure).subspan(mesh_->n_interior));
  return pressure;
}

void ThermalLoad::accept_step() {
  temperature_.accept_step();
  lame_.accepted = lame_.trial;
  set_accepted();
}

void ThermalLoad::visit(io::Archive& archive) {
  temperature_.visit(archive);
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
  if (!archive.reads()) return;
  lame_.trial = lame_.accepted;
  set_accepted();
}

double ThermalLoad::modulus(Index cell) const {
  const elastic::LameConstants& lame = elastic_->lame(cell);
  return (is_plane_stress(parameters_) ? 2 : 3) * lame.lambda + 2 * lame.mu;
}

// Constants as in the operator: mean within a material.
double ThermalLoad::face_modulus(Index face) const {
  const double here = modulus(mesh_->owner[face]);
  return face < mesh_->n_interior ? 0.5 * (here + modulus(mesh_->neighbour[face])) : here;
}

double ThermalLoad::three_bulk(Index cell) const {
  elastic::LameConstants lame = elastic_->lame(cell);
  if (is_plane_stress(parameters_)) lame.lambda = 2 * lame.lambda * lame.mu / (2 * lame.mu - lame.lambda);
  return 3 * lame.lambda + 2 * lame.mu;
}

std::vector<double> ThermalLoad::strain(std::span<const double> temperature) const {
  std::vector<double> result(temperature.size());
  for (std::size_t f = 0; f < temperature.size(); ++f)
    result[f] = materials_[mesh_->material_of(mesh_->owner[f])].expansion->integral(temperature_.reference(),
                                                                                    temperature[f]);
  return result;
}

std::vector<double> ThermalLoad::stress_of(const std::vector<double>& strain) const {
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

void ThermalLoad::add_face_stress(Index first, std::span<Tensor3> stress) const {
  if (!expands()) return;
  for (std::size_t i = 0; i < stress.size(); ++i)
    stress[i].diagonal().array() -= accepted_.stress[std::size_t(first) + i];
}

std::vector<double> ThermalLoad::pyramid_means(const std::vector<double>& of_faces) const {
  const Index n_owned = mesh_->cells.n_owned();
  std::vector<double> total(n_owned, 0), weight(n_owned, 0);
  elastic::visit_pyramids(*mesh_, elastic_->geometry(), [&](Index c, Index f, double pyramid) {
    total[c] += pyramid * of_faces[f];
    weight[c] += pyramid;
  });
  for (Index c = 0; c < n_owned; ++c) total[c] /= weight[c];
  return total;
}

std::vector<double> ThermalLoad::cell_strain() const {
  if (!by_cells()) return pyramid_means(accepted_.strain);
  std::vector<double> result = pyramid_means(accepted_.stress);
  for (std::size_t c = 0; c < result.size(); ++c) result[c] /= modulus(static_cast<Index>(c));
  return result;
}

void ThermalLoad::add_cell_stress(std::span<Tensor3> stress) const {
  if (!expands()) return;
  const std::vector<double> strain = cell_strain();
  for (Index c = 0; c < std::ssize(strain); ++c) stress[c].diagonal().array() -= modulus(c) * strain[c];
}

// tr(sigma) = 3 K [tr(eps) - 3 epsilon], also in plane strain and plane stress.
void ThermalLoad::take_stress(std::span<const Tensor3> stress) {
  const std::vector<double> strain = cell_strain();
  for (std::size_t c = 0; c < stress.size(); ++c) {
    const double now = stress[c].trace() / three_bulk(static_cast<Index>(c)) + 3 * strain[c];
    dilation_.rate[c] = (now - dilation_.value[c]) / dt_;
    dilation_.value[c] = now;
  }
}

/// (3 K alpha)^2 T/((lambda + 2 mu) rho c): relative stiffening by the coupling, largest over the materials.
double ThermalLoad::coupling_number() const {
  double most = 0;
  const double temperature = temperature_.seen().second;
  for (const auto& [m, expansion, young, poisson] : materials_) {
    if (!temperature_.heat() || !expansion || !m.heat.specific_heat) continue;
    const double e = m.youngs_modulus, nu = m.poissons_ratio;
    const double beta = e / (1 - 2 * nu) * (*expansion)(temperature);
    const double stiff = e * (1 - nu) / ((1 + nu) * (1 - 2 * nu));
    const double capacity =
        m.density * fv::Property(*m.heat.specific_heat, "material.specific-heat")(temperature);
    most = std::max(most, beta * beta * temperature / (stiff * capacity));
  }
  return most;
}

}  // namespace couplet::solid
