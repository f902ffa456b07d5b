// SPDX-License-Identifier: Apache-2.0

#include "solid_solver/solid.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "common/base/error.hpp"
#include "common/diagnostics/results.hpp"
#include "common/elasticity/vector_at.hpp"
#include "common/fv/use.hpp"
#include "common/io/checkpoint.hpp"
#include "common/io/probes/place_search.hpp"
#include "common/io/probes/probe.hpp"
#include "common/time/steadiness.hpp"
#include "solid_solver/analysis/modal_analysis.hpp"
#include "solid_solver/output/quantities.hpp"
#include "solid_solver/thermal/thermal_load.hpp"

namespace couplet::solid {

Solid::Solid(mesh::LoadedMesh body, SolidParameters parameters, SolidContext context)
    : context_(std::move(context)),
      body_(std::move(body), std::move(parameters)),
      interface_(body_),
      stepper_(body_),
      fields_(body_, stepper_.state(), stepper_.last_solve()),
      output_(fields_, stepper_, body_, context_),
      is_loaded_by_case_(!body_.parameters().heat && body_.parameters().output.modes == 0 &&
                         body_.boundaries().interface_patches().empty()) {
  for (const auto& [name, quantity] :
       body_.parameters().quantities)  // a place outside is an error now, not at the end
    if (!quantity.point.empty()) io::Probe(body_.mesh(), body_.geometry().points, name, place_of(quantity));
}

void Solid::begin_step(const coupling::Step& step) {
  stepper_.begin_step(step, !interface_.is_heated());
  if (!body_.is_dynamic() || step.number != 0) return;
  if (body_.parameters().output.spectrum) output_.write_spectrum(step.dt);
  if (body_.parameters().output.modes > 0) output_.write_modes();
}

coupling::Exchange Solid::solve(const coupling::Exchange& in) {
  if (interface_.is_heated()) {
    interface_.take_heating(in);
    stepper_.prepare_loads();
  }
  stepper_.solve(interface_.load(in));
  return interface_.values(stepper_.trial());
}

coupling::StepReport Solid::accept_step() {
  stepper_.accept_step();
  ThermalLoad* thermal = body_.thermal();
  if (thermal && thermal->wants_stress())
    thermal->take_stress(fields_.cell_stress(fields_.point_displacement()));
  if (is_loaded_by_case_) {  // a run at rest is a finding
    fv::Use& motion = fv::uses()["energy"];
    motion.kind = fv::Use::Kind::energy;
    double largest = 0;
    for (const double u : stepper_.state().cell_u) largest = std::max(largest, std::abs(u));
    motion.note(largest);
  }
  return {.dt = stepper_.state().dt, .iterations = stepper_.effort().iterations};
}

double Solid::change() const {
  const std::size_t owned = std::size_t(body_.mesh().cells.n_owned() * body_.mesh().dim);
  const double moved = time::change_over_size(
      body_.mesh().comm, std::span(stepper_.state().cell_u).first(owned), stepper_.trial().cell_u);
  const Heat* heat = body_.temperature() ? body_.temperature()->heat() : nullptr;
  return heat ? std::max(moved, heat->change()) : moved;
}

std::vector<std::string> Solid::finish() {
  const SolidOutputParameters& chosen = body_.parameters().output;
  if (chosen.buckling > 0) output_.write_buckling();
  if (chosen.modes > 0 && !body_.is_dynamic()) output_.write_preloaded_modes();
  const int dim = body_.mesh().dim;
  const std::vector<double> u = fields_.point_displacement();
  std::pair<double, Vec3> most{0, Vec3::Zero()};
  for (Index v = 0; v < body_.mesh().points.n_owned(); ++v)
    if (const double size = elastic::vector_at(u, v, dim).norm(); size > most.first)
      most = {size, body_.geometry().points[v]};
  diagnostics::set_largest(body_.mesh().comm, "largest displacement", "m", most.first, most.second);
  const std::string missing = chosen.modes > 0 || chosen.buckling > 0 ? missing_shapes(body_) : "";
  if (!missing.empty()) return {missing};
  return {};
}

void Solid::write_output(double time, int number) {
  stepper_.release_solver();
  output_.write_fields(time, number, fields_.point_displacement());
}

void Solid::write_monitors(double time) {
  stepper_.release_solver();
  output_.write_series(time, fields_.point_displacement());
}

void Solid::visit(io::Archive archive) {
  stepper_.visit(archive);
  if (body_.thermal()) body_.thermal()->visit(archive);
  if (archive.reads()) body_.place_expansion(stepper_.state().time);
  stepper_.visit_guesses(archive);
}

void Solid::save(io::CheckpointWriter& file) const {
  file.on(body_.mesh());
  const_cast<Solid*>(this)->visit(io::Archive(file));  // writing changes nothing
}

void Solid::load(io::CheckpointReader& file) {
  file.on(body_.mesh());
  visit(io::Archive(file));
}

ThermalSolid::ThermalSolid(mesh::LoadedMesh body, SolidParameters parameters, SolidContext context)
    : mesh_(std::move(body.mesh)),
      geometry_(std::move(body.geometry)),
      parameters_(std::move(parameters)),
      context_(std::move(context)),
      heat_(make_heat(mesh_, geometry_, parameters_)),
      series_(context_, mesh_.comm) {
  check_names(mesh_, parameters_);
  std::vector<Vec3> places;
  for (const auto& [name, probe] : parameters_.probes) {
    probes_.emplace_back(mesh_, geometry_.points, name, probe.point);
    places.push_back(probe.point);
  }
  io::check_mesh_scale(mesh_, geometry_.points, places, parameters_.mesh_scale);
  check_heat_quantities(*heat_, parameters_.quantities);
  if (const auto& patches = heat_->boundaries().interface_patches(); !patches.empty()) {
    map_ = std::make_unique<coupling::InterfaceMap>(mesh_, patches);
    interface_.emplace(*heat_, *map_);
  }
  if (!parameters_.output.surfaces.empty())
    surfaces_.emplace(mesh_, geometry_.points, parameters_.output.surfaces, "output.surfaces");
}

coupling::Interface ThermalSolid::initialise() {
  coupling::Interface description;
  if (map_) description = map_->describe(geometry_);
  description.dim = mesh_.dim;
  if (interface_) HeatInterface::describe(description);
  return description;
}

void ThermalSolid::begin_step(const coupling::Step& step) {
  if (!(step.dt > 0)) throw Error("The solid received a step of {} s; it must be above 0.", step.dt);
  step_ = step;
}

coupling::Exchange ThermalSolid::solve(const coupling::Exchange& in) {
  if (interface_) interface_->take(in);
  heat_->solve(step_);
  coupling::Exchange out;
  if (interface_) interface_->add_film(out);
  return out;
}

void ThermalSolid::save(io::CheckpointWriter& file) const {
  file.on(mesh_);
  io::Archive archive(file);
  heat_->visit(archive);
}

void ThermalSolid::load(io::CheckpointReader& file) {
  file.on(mesh_);
  io::Archive archive(file);
  heat_->visit(archive);
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
  if (!probes_.empty()) {
    const std::vector<double> points = heat_->point_temperature(heat_->accepted());
    std::vector<std::string> columns{"time [s]"};
    std::vector<double> row{time};
    for (const auto& [name, probe] : parameters_.probes) columns.push_back(name + " temperature [K]");
    for (const io::Probe& probe : probes_)
      for (const double value : probe.sample(points, 1)) row.push_back(value);
    series_.add("probes.csv", columns, row);
  }
  std::vector<std::string> columns{"time [s]"};
  std::vector<double> row{time};
  for (const PatchHeat& h : heat_->patch_heat()) {
    columns.push_back(h.patch + " [W]");
    row.push_back(h.heat);
  }
  columns.emplace_back("stored [J]");
  row.push_back(heat_->stored_heat());
  series_.add("heat.csv", columns, row);
}

}  // namespace couplet::solid
