// SPDX-License-Identifier: Apache-2.0
#include "solid_solver/thermal_solid.hpp"

#include "common/base/error.hpp"
#include "common/io/checkpoint.hpp"
#include "common/parallel/collective.hpp"
#include "solid_solver/output/heat_quantities.hpp"
#include "solid_solver/thermal/thermal_strain.hpp"

namespace couplet::solid {

ThermalSolid::ThermalSolid(mesh::LoadedMesh body, SolidParameters parameters, SolidContext context)
    : mesh_(std::move(body.mesh)),
      geometry_(std::move(body.geometry)),
      parameters_(std::move(parameters)),
      context_(std::move(context)),
      heat_(make_heat(mesh_, geometry_, parameters_)) {
  for (const auto& [name, probe] : parameters_.probes)
    probes_.emplace_back(mesh_, geometry_.points, name, probe.point);
  check_heat_quantities(*heat_, parameters_.quantities);
  if (!parameters_.output.surfaces.empty())
    surfaces_.emplace(mesh_, geometry_.points, parameters_.output.surfaces, "output.surfaces");
}

coupling::Interface ThermalSolid::initialise() {
  coupling::Interface none;
  none.dim = mesh_.dim;
  return none;
}

void ThermalSolid::begin_step(const coupling::Step& step) {
  if (!(step.dt > 0)) throw Error("The solid received a step of {} s; it must be above 0.", step.dt);
  step_ = step;
}

coupling::Exchange ThermalSolid::solve(const coupling::Exchange&) {
  heat_->solve(step_);
  return {};
}

void ThermalSolid::save(io::CheckpointWriter& file) const {
  file.on(mesh_);
  heat_->save(file);
}

void ThermalSolid::load(io::CheckpointReader& file) {
  file.on(mesh_);
  heat_->load(file);
}

void ThermalSolid::write_output(double time, int number) {
  if (context_.output_folder.empty()) return;
  const std::vector<double> points = heat_->point_temperature(heat_->accepted());
  if (surfaces_) write_surfaces(time, points);
  if (!context_.fields.due(number)) return;
  if (!fields_)
    fields_.emplace(mesh_, geometry_.points, context_.output_folder, context_.name, false,
                    context_.restart_time, context_.fields);
  fields_->write(time, geometry_.points,
                 {{"temperature", "K", io::OutputField::Place::points, 1, points},
                  {"cell-temperature", "K", io::OutputField::Place::cells, 1, heat_->accepted().cells}});
}

void ThermalSolid::write_surfaces(double time, std::span<const double> points) {
  if (!surfaces_open_) surfaces_->open(context_.output_folder, false, context_.restart_time);
  surfaces_open_ = true;
  const std::vector<double> inflow = heat_->boundary_inflow();
  for (std::size_t i = 0; i < surfaces_->patches().size(); ++i)
    surfaces_->write(i, time, geometry_.points,
                     {{"temperature", "K", io::OutputField::Place::points, 1, points},
                      {"heat-flux", "W/m^2", io::OutputField::Place::cells, 1, inflow}});
}

void ThermalSolid::write_monitors(double time) {
  if (context_.output_folder.empty()) return;
  if (!probes_.empty()) write_probes(time);
  write_heat(time);
}

void ThermalSolid::write_probes(double time) {
  const std::vector<double> points = heat_->point_temperature(heat_->accepted());
  std::vector<double> row{time};
  for (const io::Probe& probe : probes_) {
    const std::vector<double> value = probe.sample(points, 1);
    row.insert(row.end(), value.begin(), value.end());
  }
  if (parallel::comm_rank(mesh_.comm) != 0) return;
  if (!probe_series_) {
    std::vector<std::string> columns{"time [s]"};
    for (const auto& [name, probe] : parameters_.probes) columns.push_back(name + " temperature [K]");
    probe_series_.emplace(context_.output_folder / "probes.csv", columns, context_.restart_time);
  }
  probe_series_->row(row);
}

void ThermalSolid::write_heat(double time) {
  const std::vector<PatchHeat> heat = heat_->patch_heat();
  std::vector<double> row{time};
  for (const PatchHeat& h : heat) row.push_back(h.heat);
  row.push_back(heat_->stored_heat());
  if (parallel::comm_rank(mesh_.comm) != 0) return;
  if (!heat_series_) {
    std::vector<std::string> columns{"time [s]"};
    for (const PatchHeat& h : heat) columns.push_back(h.patch + " [W]");
    columns.emplace_back("stored [J]");
    heat_series_.emplace(context_.output_folder / "heat.csv", columns, context_.restart_time);
  }
  heat_series_->row(row);
}

}  // namespace couplet::solid
