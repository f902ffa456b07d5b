// SPDX-License-Identifier: Apache-2.0
#include "thermocline/model/tank.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>

#include "common/base/error.hpp"
#include "common/diagnostics/finding.hpp"
#include "common/io/archive.hpp"
#include "common/io/checkpoint.hpp"
#include "common/log/log.hpp"
#include "common/parallel/collective.hpp"
#include "thermocline/model/questions.hpp"

namespace couplet::thermocline {

namespace {

/// Parts of the tank and its plant that cost something.
Inventory inventory_of(const TankSetup& setup) {
  const TankParameters& p = setup.parameters;
  const double area = 0.25 * std::numbers::pi * p.diameter * p.diameter;
  Inventory all;
  all.field_area = p.flow.plant.field_area, all.block_power = p.flow.plant.electric_power;
  for (const auto& layer : p.bed.layers) {
    const Filler& filler = layer.filler ? *layer.filler : setup.filler;
    all.fluid += area * layer.height * layer.porosity * setup.fluid.density;
    (layer.melting ? all.capsules : all.filler) +=
        area * layer.height * (1 - layer.porosity) * filler.density;
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

/// The flow with the days of its calendar, which are those of the weather.
FlowParameters dated(FlowParameters flow, const Weather& weather) {
  flow.plant.start.day = weather.first_day();
  flow.plant.start.period = int(std::lround(weather.period_length() / seconds_a_day));
  return flow;
}

}  // namespace

Tank::Tank(const TankParameters& p, const app::ParticipantContext& context)
    : name_(context.name),
      weather_(make_weather(p.ambient, context.case_folder)),
      control_(make_flow_control(dated(p.flow, *weather_), make_fluid(p.fluid).specific_heat)),
      accepted_(std::make_shared<const TankSetup>(p), *weather_),
      next_(accepted_),
      control_state_(control_->state()),
      comm_(context.comm) {
  if ((p.external_wall || p.elsewhere) && !context.coupled)
    throw Error(
        "participants.{}.{}: no participant computes {} in a run of the tank alone. Start it together "
        "with a coupler and {}, or remove this section.",
        context.name, p.external_wall ? "external-wall" : "elsewhere", p.external_wall ? "the wall" : "them",
        p.external_wall ? "a solid_solver" : "a thermocline for each of these elements");
  if (p.external_wall)
    wall_.emplace(*p.external_wall, *accepted_.setup().rings);
  else if (p.elsewhere && p.elsewhere->insulation)
    wall_.emplace(ExternalWallParameters{accepted_.setup().rings->size(), 0.01}, *accepted_.setup().rings);
  if (parallel::comm_rank(context.comm) == 0)
    files_ = std::make_unique<TankOutputFiles>(accepted_, context.output_folder, context.restart_time);
  if (p.insulation)
    require_sun(p.insulation->outside.solar_absorptance, *weather_,
                fmt::format("participants.{}.insulation.solar-absorptance", context.name));
  report("weather-data", weather_->doubts());
  if (files_) {
    for (const std::string& sentence : weather_->warnings()) log::warn("{}", sentence);
    if (std::isnan(context.restart_time))
      for (const std::string& sentence : questions(p, accepted_)) log::warn("{}: {}", context.name, sentence);
  }
  const PlantParameters plant = dated(p.flow, *weather_).plant;
  report("calendar", Calendar(plant.calendar, plant.start).doubts());
  if (p.report) {
    auto books = std::make_unique<DayReport>(
        *p.report, Plant(plant, make_fluid(p.fluid).specific_heat), *weather_,
        files_ ? context.output_folder : std::filesystem::path(), context.restart_time);
    const Inventory inventory = inventory_of(accepted_.setup());
    books->take_stock(inventory);
    if (p.report->economics)
      report("prices", prices_for_nothing(*p.report->economics, inventory, p.pump.has_value()));
    add_observer(std::move(books));
  }
}

void Tank::report(const char* id, const std::vector<std::string>& sentences) const {
  for (const std::string& sentence : sentences)
    diagnostics::finding(parallel::comm_rank(comm_),
                         {.id = id, .sentence = fmt::format("{}: {}", name_, sentence)});
}

coupling::Interface Tank::initialise() {
  const TankParameters& p = accepted_.setup().parameters;
  if (parallel::comm_rank(comm_) != 0 || (!p.external_wall && !p.elsewhere)) return {};
  constexpr auto faces = coupling::Interface::Place::faces;
  coupling::Interface interface;
  if (wall_) {
    interface = wall_->describe();
  } else {
    interface.face_centres = {{0, 0, 0}};
    interface.face_areas = {{0, 0, -accepted_.bed().area()}};
  }
  if (p.external_wall) {
    interface.takes = {{"displacement", "m", coupling::Interface::Place::vertices}};
    interface.gives = {{"temperature", "K", faces, 1}, {"pressure", "Pa", faces, 1}};
  }
  if (p.elsewhere && p.elsewhere->insulation) {
    interface.takes.push_back({"wall-heat", "W", faces, 1});
    interface.gives.push_back({"wall-temperature", "K", faces, 1});
    interface.gives.push_back({"wall-diameter", "m", faces, 1});
    interface.gives.push_back({"wall-height", "m", faces, 1});
  }
  if (p.elsewhere && p.elsewhere->ground) {
    interface.takes.push_back({"bottom-heat", "W", faces, 1});
    interface.gives.push_back({"bottom-temperature", "K", faces, 1});
    interface.gives.push_back({"bottom-coefficient", "W/(m^2 K)", faces, 1});
    interface.gives.push_back({"tank-diameter", "m", faces, 1});
  }
  return interface;
}

double Tank::suggest_dt() {
  const auto& elsewhere = accepted_.setup().parameters.elsewhere;
  return elsewhere && elsewhere->ground ? accepted_.stable_ground() : std::numeric_limits<double>::infinity();
}

/// Values that other participants take, at the end of the step, on rank 0.
coupling::Exchange Tank::given() const {
  const TankParameters& p = accepted_.setup().parameters;
  coupling::Exchange out;
  if (parallel::comm_rank(comm_) != 0) return out;
  if (p.external_wall) {
    out["temperature"] = wall_->to_sections(next_.shell()->temperature());
    out["pressure"] = wall_->to_sections(next_.contact()->pressure());
  }
  if (!p.elsewhere) return out;
  const std::size_t faces = wall_ ? wall_->sections() : 1;
  if (p.elsewhere->insulation) {
    out["wall-temperature"] = wall_->to_sections(next_.shell()->temperature());
    const Rings& rings = *next_.setup().rings;
    out["wall-diameter"].assign(faces, p.diameter + 2 * rings.thickness.front());
    out["wall-height"].assign(faces, rings.z.back() + rings.dz.back() / 2);
  }
  if (p.elsewhere->ground) {
    out["bottom-temperature"].assign(faces, next_.bed().bottom());
    out["bottom-coefficient"].assign(faces, next_.plate_coefficient());
    out["tank-diameter"].assign(faces, p.diameter);
  }
  return out;
}

/// Every rank computes the tank, so every rank needs what rank 0 got.
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
  control_->restore(control_state_);
  steps_.clear();
  next_.advance(step_.time, step_.dt, *control_, *weather_, steps_, speed_);
  if (p.external_wall) {
    std::vector<double> radial;
    if (const auto u = received(in, "displacement"); !u.empty()) radial = wall_->radial(u);
    next_.update_contact(radial);
  }
  return given();
}

coupling::StepReport Tank::accept_step() {
  const Ledger &before = accepted_.ledger(), &now = next_.ledger();
  stored_ = now.bed - before.bed;
  side_ = now.side - before.side, roof_ = now.roof - before.roof, ground_ = now.ground - before.ground;
  std::swap(accepted_, next_);
  control_state_ = control_->state();
  look_at_bending();
  for (const BedStep& s : steps_) {
    peak_flow_ = std::max(peak_flow_, std::abs(s.flow.mass_flow));
    peak_advance_ = std::max(peak_advance_, std::abs(s.flow.mass_flow) * s.dt);
  }
  report("tank-state", accepted_.take_warnings());
  if (!observers_.empty()) {
    accepted_.bed().filler_temperature(filler_);
    const TankRecord r = record();
    for (const auto& observer : observers_) observer->record(r);
  }
  return {.dt = step_.dt};
}

void Tank::look_at_bending() {
  constexpr double every = 2 * 3600;  // [s]
  const double end = step_.time + step_.dt;
  if (!accepted_.shell() || accepted_.contact() ||
      std::floor(end / every + 1e-9) == std::floor(step_.time / every + 1e-9))
    return;
  const Rings& rings = *accepted_.setup().rings;
  const std::vector<double>& hoop = accepted_.stress().hoop;
  const WallBending bent =
      wall_bending(rings, *accepted_.setup().steel, hoop, accepted_.shell()->temperature());
  bending_.rings = std::max(bending_.rings, *std::max_element(hoop.begin(), hoop.end()));
  if (!accepted_.stress().yield.empty()) {
    const YieldShares now = yield_shares(accepted_.stress(), bent, accepted_.setup().steel->poissons_ratio);
    bending_.share.rings = std::max(bending_.share.rings, now.rings);
    bending_.share.shell = std::max(bending_.share.shell, now.shell);
  }
  for (std::size_t i = 0; i < hoop.size(); ++i) {
    if (bent.hoop[i] > bending_.shell) bending_.shell = bent.hoop[i], bending_.shell_z = rings.z[i];
    if (std::abs(bent.axial[i]) > bending_.axial)
      bending_.axial = std::abs(bent.axial[i]), bending_.axial_z = rings.z[i], bending_.axial_time = end;
  }
}

TankRecord Tank::record() const {
  const TankModel& m = accepted_;
  TankRecord r;
  r.time = step_.time + step_.dt;
  r.dt = step_.dt;
  r.steps = steps_;
  r.z = m.bed().grid().z, r.dz = m.bed().grid().dz;
  r.fluid_temperature = m.bed().fluid();
  r.filler_temperature = filler_;
  if (m.shell()) {
    r.wall_z = m.setup().rings->z;
    r.wall_temperature = m.shell()->temperature();
    r.hoop_stress = m.stress().hoop;
    r.equivalent_stress = m.stress().equivalent;
    r.yield_strength = m.stress().yield;
  }
  r.stored = stored_, r.loss_side = side_, r.loss_roof = roof_, r.loss_ground = ground_;
  const PlantParameters& plant = m.setup().parameters.flow.plant;
  r.heat_capacity = plant.hot > plant.cold
                        ? m.bed().heat_between(plant.cold, plant.hot) / (plant.hot - plant.cold)
                        : m.bed().heat_capacity();
  return r;
}

void Tank::save(io::CheckpointWriter& file) const {
  for (const auto& [name, values] : accepted_.state()) file.write_common(name, values);
  file.write_common("flow-control", control_state_);
  for (std::size_t i = 0; i < observers_.size(); ++i)
    file.write_common("observer-" + std::to_string(i), observers_[i]->state());
  io::Archive archive(file);
  const_cast<Tank*>(this)->visit_seen(archive);  // writing changes nothing
}

/// Saves or loads what the run has seen for its findings.
void Tank::visit_seen(io::Archive& archive) { archive.common("seen", peak_flow_, peak_advance_, bending_); }

void Tank::load(io::CheckpointReader& file) {
  accepted_.restore([&](const std::string& name) { return file.read_common(name); });
  control_state_ = file.read_common("flow-control");
  control_->restore(control_state_);
  for (std::size_t i = 0; i < observers_.size(); ++i)
    observers_[i]->restore(file.read_common("observer-" + std::to_string(i)));
  io::Archive archive(file);
  visit_seen(archive);
}

void Tank::write_output(double time, int) {
  if (files_) files_->profiles(accepted_, time);
}

void Tank::write_monitors(double time) {
  if (files_ && !steps_.empty()) files_->monitor(accepted_, time, steps_.back());
}

}  // namespace couplet::thermocline
