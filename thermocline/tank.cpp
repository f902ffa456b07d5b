// SPDX-License-Identifier: Apache-2.0
#include "thermocline/tank.hpp"

#include <algorithm>
#include <cmath>

#include "common/base/error.hpp"
#include "common/io/checkpoint.hpp"
#include "common/log/log.hpp"
#include "common/parallel/collective.hpp"

namespace couplet::thermocline {

Tank::Tank(const TankParameters& p, const ParticipantContext& context)
    : name_(context.name),
      weather_(make_weather(p.ambient, context.case_folder)),
      control_(make_flow_control(p.flow, make_fluid(p.fluid).specific_heat)),
      accepted_(std::make_shared<const TankSetup>(p), *weather_),
      next_(accepted_),
      control_state_(control_->state()),
      comm_(context.comm) {
  if (p.external_wall) {
    if (!context.coupled)
      throw Error(
          "participants.{}.external-wall: nobody computes the wall in a run of the tank alone. Start it "
          "together with a "
          "coupler and a solid_solver, or remove this section.",
          context.name);
    wall_.emplace(*p.external_wall, *accepted_.setup().rings);
  }
  if (comm_rank(context.comm) == 0)
    files_ = std::make_unique<TankOutputFiles>(accepted_, context.output_folder, context.restart_time);
  if (files_)
    for (const std::string& sentence : weather_->warnings()) log::warn("{}", sentence);
  if (p.report)
    add_observer(std::make_unique<DayReport>(
        *p.report, Plant(p.flow.plant, make_fluid(p.fluid).specific_heat), *weather_,
        files_ ? context.output_folder : std::filesystem::path(), context.restart_time));
}

Interface Tank::initialise() { return wall_ && comm_rank(comm_) == 0 ? wall_->describe() : Interface{}; }

/// Temperature and pressure at the end of the step, on rank 0.
Exchange Tank::given() const {
  if (!wall_ || comm_rank(comm_) != 0) return {};
  return {{"temperature", wall_->to_sections(next_.shell()->temperature())},
          {"pressure", wall_->to_sections(next_.contact()->pressure())}};
}

Exchange Tank::solve(const Exchange& in) {
  next_ = accepted_;
  control_->restore(control_state_);
  steps_.clear();
  next_.advance(step_.time, step_.dt, *control_, *weather_, steps_, speed_);
  if (wall_) {
    // Every rank computes the tank, so every rank needs the wall's answer.
    std::vector<double> radial;
    if (const auto found = in.find("displacement"); found != in.end()) radial = wall_->radial(found->second);
    int n = int(radial.size());
    MPI_Bcast(&n, 1, MPI_INT, 0, comm_);
    radial.resize(n);
    MPI_Bcast(radial.data(), n, MPI_DOUBLE, 0, comm_);
    next_.update_contact(radial);
  }
  return given();
}

void Tank::accept_step() {
  const Ledger &before = accepted_.ledger(), &now = next_.ledger();
  stored_ = now.bed - before.bed;
  side_ = now.side - before.side, roof_ = now.roof - before.roof, ground_ = now.ground - before.ground;
  std::swap(accepted_, next_);
  control_state_ = control_->state();
  for (const BedStep& s : steps_) peak_flow_ = std::max(peak_flow_, std::abs(s.flow.mass_flow));
  for (const std::string& sentence : accepted_.take_warnings())
    if (files_) log::warn("{}", sentence);
  if (observers_.empty()) return;
  accepted_.bed().filler_temperature(filler_);
  const TankRecord r = record();
  for (const auto& observer : observers_) observer->record(r);
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

void Tank::save(CheckpointWriter& file) const {
  for (const auto& [name, values] : accepted_.state()) file.write(name, values);
  file.write("flow-control", control_state_);
  for (std::size_t i = 0; i < observers_.size(); ++i)
    file.write("observer-" + std::to_string(i), observers_[i]->state());
}

void Tank::load(CheckpointReader& file) {
  accepted_.restore([&](const std::string& name) { return file.read(name); });
  control_state_ = file.read("flow-control");
  control_->restore(control_state_);
  for (std::size_t i = 0; i < observers_.size(); ++i)
    observers_[i]->restore(file.read("observer-" + std::to_string(i)));
}

void Tank::write_output(double time, int) {
  if (files_) files_->profiles(accepted_, time);
}

void Tank::write_monitors(double time) {
  if (files_ && !steps_.empty()) files_->monitor(accepted_, time, steps_.back());
}

}  // namespace couplet::thermocline
