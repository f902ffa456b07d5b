// SPDX-License-Identifier: Apache-2.0
#include "coupler/coupler.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "common/base/error.hpp"
#include "common/base/text.hpp"
#include "common/log/log.hpp"
#include "common/parallel/collective.hpp"
#include "coupler/exchange/foreign_fluid.hpp"
#include "coupler/exchange/foreign_structure.hpp"
#include "coupler/exchange/introductions.hpp"
#include "coupler/exchange/role_checks.hpp"
#include "coupler/judge/places.hpp"
#include "coupler/judge/surfaces.hpp"

namespace couplet::coupler {
namespace {

/// Columns of balance.csv speak of roles where there are such.
std::vector<std::string> labels_of(const CouplingParameters& p, const std::vector<Partner>& partners) {
  std::vector<std::string> labels;
  for (const Partner& partner : partners) {
    const std::string& name = partner.name();
    labels.push_back(!p.exchange && p.fluid && name == p.fluid->participant           ? "fluid"
                     : !p.exchange && p.structure && name == p.structure->participant ? "structure"
                                                                                      : name);
  }
  return labels;
}

}  // namespace

Coupler::Coupler(MPI_Comm comm, const CouplingParameters& parameters,
                 const app::SimulationParameters& simulation,
                 std::vector<std::unique_ptr<coupling::Channel>> channels, CouplerFolders folders)
    : comm_(comm),
      parameters_(parameters),
      simulation_(simulation),
      schedule_(schedule_of(parameters)),
      folders_(std::move(folders)),
      loop_(comm, simulation, parameters.scheme.first, folders_.checkpoints),
      scheme_(parameters.scheme),
      oscillation_guard_(comm) {
  if (schedule_.iterates) accelerator_ = make_accelerator(parameters.acceleration, comm);
  for (const std::string& name : schedule_.everyone()) {
    const auto found = std::ranges::find_if(channels, [&](const auto& c) { return c && c->name() == name; });
    if (found == channels.end()) throw Error("The coupler has no channel to '{}'.", name);
    Partner& partner = partners_.emplace_back();
    partner.channel = std::move(*found);
    partner.sub_steps = schedule_.sub_steps_of(name);
    if (const auto& structure = parameters.structure;
        structure && structure->participant == name && structure->foreign())
      partner.channel = std::make_unique<ForeignStructure>(std::move(partner.channel), *structure);
    if (const auto& fluid = parameters.fluid; fluid && fluid->participant == name && fluid->foreign())
      partner.channel = std::make_unique<ForeignFluid>(std::move(partner.channel), *fluid);
  }
  for (const std::string& name : schedule_.group) group_.push_back(index_of(name));
  given_.resize(partners_.size());
  taken_.resize(partners_.size());
}

namespace {

CouplingParameters with_roles(CouplingParameters p, const CouplerChannels& c) {
  if (!p.fluid) p.fluid.emplace();
  p.fluid->participant = c.fluid->name();
  if (!p.structure) p.structure.emplace();
  p.structure->participant = c.structure->name();
  if (c.mesh) p.mesh = {c.mesh->name()};
  return p;
}

std::vector<std::unique_ptr<coupling::Channel>> list(CouplerChannels c) {
  std::vector<std::unique_ptr<coupling::Channel>> channels;
  for (auto* one : {&c.fluid, &c.structure, &c.mesh}) channels.push_back(std::move(*one));
  return channels;
}

}  // namespace

Coupler::Coupler(const CouplingParameters& parameters, const app::SimulationParameters& simulation,
                 CouplerChannels channels, CouplerFolders folders)
    // Braces: the names are read before the channels are taken away.
    : Coupler{MPI_COMM_SELF, with_roles(parameters, channels), simulation, list(std::move(channels)),
              std::move(folders)} {}

std::size_t Coupler::index_of(const std::string& name) const {
  for (std::size_t i = 0; i < partners_.size(); ++i)
    if (partners_[i].channel && partners_[i].name() == name) return i;
  throw Error("'{}' is not a participant of this coupling.", name);
}

std::vector<Partner*> Coupler::everyone() {
  std::vector<Partner*> all;
  for (Partner& p : partners_) all.push_back(&p);
  return all;
}

void Coupler::initialise() {
  enter_(app::Phase::initialise, {});
  std::vector<coupling::Interface> interfaces = initialise_all(everyone());
  check_introductions(parameters_, partners_);
  for (std::size_t i = 0; i < partners_.size(); ++i)
    if (auto* foreign = dynamic_cast<ForeignFluid*>(partners_[i].channel.get()))
      foreign->adapt(interfaces[i], partners_[i].surfaces);
  for (std::size_t i = 0; i < partners_.size(); ++i)
    if (auto* foreign = dynamic_cast<ForeignStructure*>(partners_[i].channel.get()))
      foreign->adapt(interfaces[i], partners_[i].surfaces, interfaces);
  for (std::size_t i = 0; i < partners_.size(); ++i)
    sides_.emplace_back(comm_, partners_[i].name(), std::move(interfaces[i])).surfaces =
        std::move(partners_[i].surfaces);
  check_roles(parameters_, sides_);
  links_.emplace(comm_, sides_, parameters_.mapping);
  for (const std::string& note : links_->notes()) log::info("{}", note);
  check_foreseen(sides_, *links_, schedule_, group_);
  check_places(comm_, sides_, *links_, parameters_.mapping);
  compare_surfaces(comm_, sides_, *links_, schedule_);
  still_guard_.emplace(comm_, sides_);
  data_guard_.emplace(comm_, sides_);
  unknown_.emplace(comm_, sides_, *links_, group_, schedule_.side_by_side);
  audit_.emplace(comm_, sides_, *links_);
  if (simulation_.error_estimate && schedule_.iterates) errors_.emplace();
  mechanics_.emplace(comm_, sides_, *links_, labels_of(parameters_, partners_));
  exchange_initial_values();
  volume_level_.emplace(comm_, sides_, *links_, schedule_, group_);
  if (volume_level_->empty()) volume_level_.reset();
  if (!parameters_.watch.empty()) watched_.emplace(comm_, sides_, parameters_.watch);
  // Sub-steps see a line through what was given; the level of closed fluids answers by itself.
  if (simulation_.error_estimate && !schedule_.iterates && schedule_.sub_steps.empty() && !volume_level_)
    lag_.emplace(comm_, *unknown_);
  if (lag_ && !lag_->possible()) lag_.reset();
}

void Coupler::give_back(std::vector<coupling::Exchange> given) {
  for (std::size_t i = 0; i < given.size(); ++i) partners_[i].channel->reuse(std::move(given[i]));
}

void Coupler::accept(double time, int output) {
  enter_(app::Phase::accept, {});
  ask_all(everyone(), {coupling::Op::accept_step, {}, {}, time, output, ""});
  enter_(app::Phase::accept, time);
  // Scales are found after the first step, and hold from then on.
  if (!unknown_->scaled() && unknown_->complete(given_)) {
    unknown_->scale(given_);
    last_.image = unknown_->gather(given_);
    history_ = {};
    // What it has learnt was in other scales.
    start_acceleration();
  }
  if (unknown_->has_within()) last_.image = unknown_->ends(std::move(last_.image));
  if (errors_ && history_.now.unknown.size() == last_.image.unknown.size())
    errors_->accepted(last_.residual, worst(unknown_->measure(history_.now, last_.image)), last_dt_);
  if (lag_ && !history_.now.rider.empty()) lag_->accepted(last_.x, last_.image, last_dt_);
  history_.accepted(last_.image, last_dt_, schedule_.predictor);
  if (volume_level_) {
    volume_level_->accept(given_);
    monitor_->volume(time, *volume_level_);
  }
  const std::vector<SideBalance> balances = mechanics_->accepted(given_, taken_);
  if (!balances.empty()) monitor_->balance(time, balances);
  if (parameters_.exchange) monitor_->amounts(time, links_->amounts(given_));
  if (watched_) monitor_->watched(time, watched_->columns(), watched_->row(given_, taken_));
  if (output >= 0 && interface_output_) interface_output_->write(time, output, given_, taken_);
  watch(time, balances);
  if (scheme_.accepted(time)) start_acceleration();
}

std::string Coupler::run() {
  initialise();
  const std::string stateless = without_state(simulation_.checkpoint_interval, partners_);
  double restart_time = std::numeric_limits<double>::quiet_NaN();
  if (!folders_.restart.empty()) {
    load();
    restart_time = app::read_run_state(folders_.restart).time;
  }
  std::vector<std::string> names;
  for (const Partner& p : partners_) names.push_back(p.name());
  monitor_.emplace(comm_, folders_.output, names, mechanics_->labels(), mechanics_->dim(),
                   simulation_.end_time, restart_time);
  if (parameters_.interface_output)
    interface_output_.emplace(comm_, folders_.output / "interface", sides_, restart_time);
  monitor_->start(partners_);
  app::StepActions actions;
  actions.attempt = [&](const coupling::Step& step) { return attempt(step); };
  actions.accept = [&](double time, int output) { accept(time, output); };
  actions.write_start = [&](int output) {
    ask_all(everyone(), {coupling::Op::write_output, {}, {}, 0, output, ""});
  };
  actions.write_stop = [&](double time, int output) {
    ask_all(everyone(), {coupling::Op::write_output, {}, {}, time, output, ""});
  };
  actions.save = [&](const std::filesystem::path& folder) { save(folder); };
  actions.stateless = stateless;
  actions.report = [&](const coupling::Step& step, double time) {
    monitor_->step(step, time, last_, partners_);
  };
  actions.advised_dt = [&] { return advised_dt(everyone()); };
  std::string problem = loop_.run(actions);
  finalise(problem);
  return problem;
}

}  // namespace couplet::coupler
