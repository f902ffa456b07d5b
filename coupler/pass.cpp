// SPDX-License-Identifier: Apache-2.0
#include "coupler/pass.hpp"

#include <algorithm>

#include "common/base/error.hpp"
#include "common/log/log.hpp"
#include "coupler/exchange/foreign.hpp"
#include "coupler/exchange/partners.hpp"
#include "coupler/mapping/surface_checks.hpp"

namespace couplet::coupler {

Pass::Pass(MPI_Comm comm, const CouplingParameters& parameters,
           std::vector<std::unique_ptr<coupling::Channel>> channels)
    : comm_(comm), schedule_(schedule_of(parameters)) {
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

std::size_t Pass::index_of(const std::string& name) const {
  for (std::size_t i = 0; i < partners_.size(); ++i)
    if (partners_[i].channel && partners_[i].name() == name) return i;
  throw Error("'{}' is not a participant of this coupling.", name);
}

std::vector<Partner*> Pass::everyone() {
  std::vector<Partner*> all;
  for (Partner& p : partners_) all.push_back(&p);
  return all;
}

void Pass::command_all(const coupling::Command& command) { coupler::command_all(everyone(), command); }

void Pass::initialise(const CouplingParameters& parameters) {
  std::vector<coupling::Interface> interfaces = initialise_all(everyone());
  check_introductions(parameters, partners_);
  for (std::size_t i = 0; i < partners_.size(); ++i)
    if (auto* foreign = dynamic_cast<ForeignFluid*>(partners_[i].channel.get()))
      foreign->adapt(interfaces[i], partners_[i].surfaces);
  for (std::size_t i = 0; i < partners_.size(); ++i)
    if (auto* foreign = dynamic_cast<ForeignStructure*>(partners_[i].channel.get()))
      foreign->adapt(interfaces[i], partners_[i].surfaces, interfaces);
  for (std::size_t i = 0; i < partners_.size(); ++i)
    sides_.emplace_back(comm_, partners_[i].name(), std::move(interfaces[i])).surfaces =
        std::move(partners_[i].surfaces);
  check_roles(parameters, sides_);
  links_.emplace(comm_, sides_, parameters.mapping);
  for (const std::string& note : links_->notes()) log::info("{}", note);
  check_anticipation(sides_, *links_, schedule_, group_);
  check_places(comm_, sides_, *links_, parameters.mapping);
  compare_surfaces(comm_, sides_, *links_, schedule_);
}

void Pass::exchange_initial_values() {
  for (std::size_t i = 0; i < partners_.size(); ++i) {
    given_[i] = std::move(partners_[i].initial);
    require_finite_data(i, given_[i]);
  }
  const std::vector<coupling::Exchange> initial = given_;
  for (std::size_t i = 0; i < partners_.size(); ++i) {
    if (initial[i].empty()) continue;
    partners_[i].send({coupling::Op::start, {}, links_->input(i, initial), 0, -1, ""});
    partners_[i].receive();
  }
  volume_level_.emplace(comm_, sides_, *links_, schedule_, group_);
  if (volume_level_->empty()) volume_level_.reset();
}

void Pass::require_finite_data(std::size_t i, const coupling::Exchange& given) const {
  require_finite(comm_, given, sides_[i].interface, sides_[i].interface.gives, partners_[i].name());
}

void Pass::reuse(std::vector<coupling::Exchange> data) {
  for (std::size_t i = 0; i < data.size(); ++i) partners_[i].channel->reuse(std::move(data[i]));
}

void Pass::begin_step(const coupling::Step& step) {
  command_all({coupling::Op::begin_step, step, {}, 0, -1, ""});
  if (volume_level_) volume_level_->start_step(step.dt);
  scheme_ = step.scheme;
  first_ = true;
}

const std::vector<coupling::Exchange>& Pass::operator()(std::vector<coupling::Exchange> data) {
  reuse(std::exchange(outputs_, {}));
  const bool move_mesh = schedule_.mover && (first_ || scheme_ != coupling::Scheme::semi_implicit);
  // The mover uses the motion known before any solution in this pass.
  if (move_mesh && (first_ || !schedule_.mesh_on_guess)) guess_ = links_->input(0, data);
  first_ = renewed_prediction_ = false;
  outputs_ = schedule_.side_by_side ? side_by_side(data, move_mesh) : in_sequence(std::move(data), move_mesh);
  return outputs_;
}

/// Each member takes what those before it gave in this pass (Gauss-Seidel).
std::vector<coupling::Exchange> Pass::in_sequence(std::vector<coupling::Exchange> data, bool move_mesh) {
  for (const std::size_t i : group_) {
    send_solve(i, data, move_mesh);
    receive_solution(i, data[i], move_mesh);
    if (volume_level_) enforce_volume(i, data);
  }
  return data;
}

/// All members take the data of the last pass (Jacobi). Collects failures, so that every reply is received.
std::vector<coupling::Exchange> Pass::side_by_side(const std::vector<coupling::Exchange>& data,
                                                   bool move_mesh) {
  for (const std::size_t i : group_) send_solve(i, data, move_mesh);
  std::vector<coupling::Exchange> given = data;
  std::string failures;
  bool hopeless = false;
  for (const std::size_t i : group_) {
    try {
      receive_solution(i, given[i], move_mesh);
    } catch (const SolveFailure& failure) {
      if (!failures.empty()) failures += ' ';
      failures += failure.what();
      hopeless = hopeless || dynamic_cast<const SchemeFailure*>(&failure);
    }
  }
  if (hopeless) throw SchemeFailure(failures);
  if (!failures.empty()) throw SolveFailure(failures);
  return given;
}

void Pass::send_solve(std::size_t i, const std::vector<coupling::Exchange>& data, bool move_mesh) {
  // The moved participant blocks until the mesh has moved, so the mover is asked first.
  const bool with_mover = move_mesh && schedule_.mover && partners_[i].name() == *schedule_.moved;
  if (with_mover) partners_.front().send({coupling::Op::solve, {}, guess_, 0, -1, ""});
  coupling::Command command{coupling::Op::solve, {}, links_->input(i, data), 0, -1, ""};
  partners_[i].send(command);
  taken_[i] = std::move(command.data);
}

void Pass::receive_solution(std::size_t i, coupling::Exchange& given, bool move_mesh) {
  const bool with_mover = move_mesh && schedule_.mover && partners_[i].name() == *schedule_.moved;
  // A failed motion makes the moved participant fail, too; the mover knows the reason. Receives both replies.
  std::optional<SolveFailure> mover_failed;
  if (with_mover) {
    try {
      partners_.front().receive();
    } catch (const SolveFailure& failure) {
      mover_failed = failure;
    }
  }
  try {
    coupling::Reply reply = partners_[i].receive();
    partners_[i].channel->reuse(std::exchange(given, std::move(reply.data)));
    renewed_prediction_ = renewed_prediction_ || reply.renewed;
  } catch (const SolveFailure&) {
    if (!mover_failed) throw;
  }
  if (mover_failed) throw SolveFailure(*mover_failed);
  require_finite_data(i, given);
  solved_(i, taken_[i], given);
}

/// Called after participant `i` was solved: finds the pressure levels of closed fluids.
void Pass::enforce_volume(std::size_t i, std::vector<coupling::Exchange>& data) {
  volume_level_->add_level(i, taken_[i], data[i]);
  if (i != volume_level_->structures().back()) return;
  volume_level_->find(data, [&] {
    for (const std::size_t structure : volume_level_->structures()) {
      send_solve(structure, data, false);
      receive_solution(structure, data[structure], false);
    }
  });
}

void Pass::visit(io::Archive& archive) {
  if (volume_level_) volume_level_->visit(archive, sides_);
  for (const Partner& partner : partners_)
    if (auto* foreign = dynamic_cast<ForeignStructure*>(partner.channel.get())) foreign->visit(archive);
}

}  // namespace couplet::coupler
