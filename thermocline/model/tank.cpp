// SPDX-License-Identifier: Apache-2.0
#include "thermocline/model/tank.hpp"

#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <string_view>

#include <fmt/format.h>

#include "common/base/error.hpp"
#include "common/diagnostics/finding.hpp"
#include "common/diagnostics/results.hpp"
#include "common/io/checkpoint.hpp"
#include "common/log/log.hpp"
#include "common/parallel/collective.hpp"
#include "thermocline/model/model.hpp"

namespace couplet::thermocline {

namespace {

/// Parts of tank and plant with a price.
Inventory inventory_of(const TankSetup& setup) {
  const TankParameters& p = setup.parameters;
  const double area = 0.25 * std::numbers::pi * p.diameter * p.diameter;
  Inventory all;
  all.field_area = p.flow.plant.field_area, all.block_power = p.flow.plant.electric_power;
  for (const auto& layer : p.bed.layers) {
    const double density = layer.filler ? layer.filler->density : setup.filler.density;
    all.fluid += area * layer.height * layer.porosity * setup.fluid.density;
    all.filler += area * layer.height * (1 - layer.porosity) * density;
  }
  all.foundation = area;
  if (!setup.rings) return all;
  for (int i = 0; i < setup.rings->size(); ++i)
    all.steel += setup.steel->density * setup.rings->surface(i) * setup.rings->thickness[i];
  if (p.insulation)
    all.insulated =
        area + std::numbers::pi * p.diameter * (setup.rings->z.back() + setup.rings->dz.back() / 2);
  return all;
}

/// Parameters with the calendar days of the weather.
TankParameters dated(TankParameters p, const Weather& weather) {
  p.flow.plant.start.day = weather.first_day();
  p.flow.plant.start.period = int(std::lround(weather.period_length() / seconds_a_day));
  return p;
}

}  // namespace

Tank::Tank(const TankParameters& p, const app::ParticipantContext& context)
    : name_(context.name),
      weather_(make_weather(p.ambient, context.case_folder)),
      accepted_(std::make_shared<const TankSetup>(dated(p, *weather_)), *weather_),
      next_(accepted_),
      comm_(context.comm) {
  if ((p.external_wall || p.elsewhere) && !context.coupled)
    throw Error(
        "participants.{}.{}: no participant computes {} in a run of the tank alone. Start it together "
        "with a coupler and {}, or remove this section.",
        context.name, p.external_wall ? "external-wall" : "elsewhere", p.external_wall ? "the wall" : "them",
        p.external_wall ? "a solid_solver" : "a thermocline for each of these elements");
  const TankSetup& setup = accepted_.setup();
  const FlowParameters& flow = setup.parameters.flow;
  control_ = make_flow_control(flow, setup.fluid.specific_heat);
  if (p.external_wall)
    wall_.emplace(*p.external_wall, *setup.rings);
  else if (p.elsewhere && p.elsewhere->insulation)
    wall_.emplace(ExternalWallParameters{setup.rings->size(), 0.01}, *setup.rings);
  const int rank = parallel::comm_rank(context.comm);
  if (rank == 0)
    files_ = std::make_unique<TankOutputFiles>(accepted_, context.output_folder, context.restart_time);
  const auto report = [&](const char* id, const std::vector<std::string>& sentences) {
    for (const std::string& sentence : sentences)
      if (!sentence.empty())
        diagnostics::finding(rank, {.id = id, .sentence = fmt::format("{}: {}", name_, sentence)});
  };
  report("questionable-plant", weather_->doubts());
  report("questionable-plant", {missing_weather(p)});
  report("given-without-effect", {restart_beyond_cut_off(flow)});
  if (files_)
    for (const std::string& sentence : weather_->warnings()) log::warn("{}", sentence);
  report("questionable-plant", Calendar(flow.plant.calendar, flow.plant.start).doubts());
  if (!p.report) return;
  const Inventory inventory = inventory_of(setup);
  report_ = std::make_unique<DayReport>(*p.report, Plant(flow.plant, setup.fluid.specific_heat), *weather_,
                                        files_ ? context.output_folder : std::filesystem::path(),
                                        context.restart_time);
  report_->take_stock(inventory);
  if (p.report->economics)
    report("questionable-plant", prices_for_nothing(*p.report->economics, inventory, p.pump.has_value()));
}

coupling::Interface Tank::initialise() {
  const TankParameters& p = accepted_.setup().parameters;
  constexpr auto faces = coupling::Interface::Place::faces;
  coupling::Interface interface;
  if (!p.external_wall && !p.elsewhere) return interface;
  const bool has_places = parallel::comm_rank(comm_) == 0;  // all ranks take the same data
  if (has_places && wall_) {
    interface = wall_->describe();
  } else if (has_places) {
    interface.face_centres = {{0, 0, 0}};
    interface.face_areas = {{0, 0, -accepted_.bed().area()}};
  }
  if (p.external_wall) interface.takes = {{"displacement", "m", coupling::Interface::Place::vertices}};
  if (p.elsewhere && p.elsewhere->insulation) interface.takes.push_back({"wall-heat", "W", faces, 1});
  if (p.elsewhere && p.elsewhere->ground) interface.takes.push_back({"bottom-heat", "W", faces, 1});
  if (has_places)
    for (const GivenQuantity& one : given()) interface.gives.push_back({one.name, one.unit, faces, 1});
  return interface;
}

double Tank::suggest_dt() {
  const auto& elsewhere = accepted_.setup().parameters.elsewhere;
  return elsewhere && elsewhere->ground ? accepted_.stable_ground() : std::numeric_limits<double>::infinity();
}

std::vector<Tank::GivenQuantity> Tank::given() const {
  const TankParameters& p = accepted_.setup().parameters;
  const auto everywhere = [&](double value) {
    return std::vector<double>(wall_ ? wall_->sections() : 1, value);
  };
  std::vector<GivenQuantity> all;
  if (p.external_wall) {
    all.push_back({"temperature", "K", wall_->to_sections(next_.shell()->temperature())});
    all.push_back({"pressure", "Pa", wall_->to_sections(next_.mechanics()->pressure())});
  }
  if (p.elsewhere && p.elsewhere->insulation) {
    const Rings& rings = *next_.setup().rings;
    all.push_back({"wall-temperature", "K", wall_->to_sections(next_.shell()->temperature())});
    all.push_back({"wall-diameter", "m", everywhere(p.diameter + 2 * rings.thickness.front())});
    all.push_back({"wall-height", "m", everywhere(rings.z.back() + rings.dz.back() / 2)});
  }
  if (p.elsewhere && p.elsewhere->ground) {
    all.push_back({"bottom-temperature", "K", everywhere(next_.bed().bottom())});
    all.push_back({"bottom-coefficient", "W/(m^2 K)", everywhere(next_.plate_coefficient())});
    all.push_back({"tank-diameter", "m", everywhere(p.diameter)});
  }
  return all;
}

/// Every rank computes the tank, so all ranks need the data received by rank 0.
std::vector<double> Tank::received(const coupling::Exchange& in, const char* name) const {
  std::vector<double> values;
  if (const auto found = in.find(name); found != in.end()) values = found->second;
  int n = int(values.size());
  MPI_Bcast(&n, 1, MPI_INT, 0, comm_);
  values.resize(n);
  MPI_Bcast(values.data(), n, MPI_DOUBLE, 0, comm_);
  return values;
}

coupling::Exchange Tank::solve(const coupling::Exchange& in) {
  const TankParameters& p = accepted_.setup().parameters;
  next_ = accepted_;
  if (p.elsewhere) {
    if (p.elsewhere->insulation)
      if (const auto heat = received(in, "wall-heat"); !heat.empty()) next_.hold_side(wall_->to_rings(heat));
    if (p.elsewhere->ground)
      if (const auto heat = received(in, "bottom-heat"); !heat.empty())
        next_.hold_bottom(std::accumulate(heat.begin(), heat.end(), 0.0));
  }
  control_->memory = memory_;
  happened_ = next_.advance(step_.time, step_.dt, *control_, *weather_);
  if (p.external_wall) {
    std::vector<double> radial;
    if (const auto u = received(in, "displacement"); !u.empty()) radial = wall_->radial(u);
    next_.update_contact(radial);
  }
  coupling::Exchange out;
  if (parallel::comm_rank(comm_) == 0)
    for (GivenQuantity& one : given()) out[one.name] = std::move(one.values);
  return out;
}

coupling::StepReport Tank::accept_step() {
  std::swap(accepted_, next_);
  memory_ = control_->memory;
  if (report_) report_->record(record());
  return {.dt = step_.dt};
}

TankRecord Tank::record() const {
  const TankModel& m = accepted_;
  TankRecord r;
  r.time = step_.time + step_.dt;
  r.dt = step_.dt;
  r.steps = happened_.bed;
  r.z = m.bed().grid().z, r.dz = m.bed().grid().dz;
  r.fluid_temperature = m.bed().fluid();
  m.bed().filler_temperature(r.filler_temperature);
  if (m.shell()) {
    r.wall_z = m.setup().rings->z;
    r.wall_temperature = m.shell()->temperature();
    r.equivalent_stress = m.stress().equivalent;
    r.yield_strength = m.stress().yield;
  }
  const HeatSums &now = m.ledger(), &before = next_.ledger();
  r.stored = now.bed - before.bed;
  r.losses = now.losses() - before.losses();
  const PlantParameters& plant = m.setup().parameters.flow.plant;
  r.heat_capacity = plant.hot > plant.cold
                        ? m.bed().heat_between(plant.cold, plant.hot) / (plant.hot - plant.cold)
                        : m.bed().heat_capacity();
  return r;
}

void Tank::save(io::CheckpointWriter& file) const {
  io::Archive archive(file);
  const_cast<Tank*>(this)->visit(archive);  // writing changes nothing
}

void Tank::load(io::CheckpointReader& file) {
  io::Archive archive(file);
  visit(archive);
  accepted_.resume();
}

void Tank::visit(io::Archive& archive) {
  const std::size_t needed = base::to_numbers(accepted_).size();
  std::size_t n = needed;
  archive.common("tank-size", n);
  if (n != needed)
    throw Error(
        "The checkpoint's 'tank' has {} values, this tank needs {}; run with the same elements and cells.", n,
        needed);
  archive.common("tank", accepted_);
  archive.common("flow-control", memory_);
  if (report_) archive.common("report", *report_);
}

void Tank::write_output(double time, int) {
  if (files_) files_->profiles(accepted_, time);
}

void Tank::write_monitors(double time) {
  if (files_ && !happened_.bed.empty()) files_->monitor(accepted_, time, happened_.bed.back());
}

std::vector<std::string> Tank::finish() {
  if (!report_) return {};
  report_->finish();
  constexpr double nearly_all = 95;     // [%]
  constexpr double whole_day = 86'000;  // [s]; a part of one may be the night
  for (const ReportLine& line :
       parallel::comm_rank(comm_) == 0 ? report_->lines() : std::vector<ReportLine>()) {
    if (*line.meaning) diagnostics::set_result({line.quantity + line.meaning, line.unit, {line.value}});
    if (std::string_view(line.meaning) == unmet_demand && line.value > nearly_all &&
        report_->results()[ReportSums::duration] > whole_day)
      diagnostics::finding(
          0, {.id = "questionable-plant",
              .number = line.value,
              .limit = nearly_all,
              .sentence = fmt::format("the plant misses {:.4g} % of its demand (limit {:g} %): questionable",
                                      line.value, nearly_all),
              .advice = "check the units of the field's area and of the demand"});
  }
  return {};
}

}  // namespace couplet::thermocline
