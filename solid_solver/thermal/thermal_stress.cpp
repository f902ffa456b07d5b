// SPDX-License-Identifier: Apache-2.0
// Strain and stress from the temperature.
#include <algorithm>

#include "common/elasticity/symmetric/symmetric_faces.hpp"
#include "common/parallel/collective.hpp"
#include "solid_solver/thermal/thermal_strain.hpp"

namespace couplet::solid {

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
