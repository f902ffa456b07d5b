// SPDX-License-Identifier: Apache-2.0
// The temperature in files of fields.
#include "solid_solver/thermal/thermal_strain.hpp"

namespace couplet::solid {

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
