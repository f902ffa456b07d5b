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

void Pass::ask_all(const coupling::Command& command) { coupler::ask_all(everyone(), command); }

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
  check_foreseen(sides_, *links_, schedule_, group_);
  check_places(comm_, sides_, *links_, parameters.mapping);
  compare_surfaces(comm_, sides_, *links_, schedule_);
}

void Pass::exchange_initial_values() {
  for (std::size_t i = 0; i < partners_.size(); ++i) {
    given_[i] = std::move(partners_[i].initial);
    require_finite_answer(i, given_[i]);
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

void Pass::require_finite_answer(std::size_t i, const coupling::Exchange& given) const {
  require_finite(comm_, given, sides_[i].interface, sides_[i].interface.gives, partners_[i].name());
}

void Pass::give_back(std::vector<coupling::Exchange> given) {
  for (std::size_t i = 0; i < given.size(); ++i) partners_[i].channel->reuse(std::move(given[i]));
}

std::vector<coupling::Exchange> Pass::operator()(std::vector<coupling::Exchange> known, bool first,
                                                 coupling::Scheme scheme) {
  const bool move_mesh = schedule_.mover && (first || scheme != coupling::Scheme::semi_implicit);
  // The mover uses the motion known before any answer in this pass.
  if (move_mesh && (first || !schedule_.mesh_on_guess)) guess_ = links_->input(0, known);
  answered_anew_ = false;
  if (schedule_.side_by_side) return side_by_side(known, move_mesh);
  for (const std::size_t i : group_) {
    ask(i, known, move_mesh);
    answer(i, known[i], move_mesh);
    if (volume_level_) hold_volume(i, known);
  }
  return known;
}

/// Sends to all members of the group first. Collects failures, so that every reply is received.
std::vector<coupling::Exchange> Pass::side_by_side(const std::vector<coupling::Exchange>& known,
                                                   bool move_mesh) {
  for (const std::size_t i : group_) ask(i, known, move_mesh);
  std::vector<coupling::Exchange> given = known;
  std::string failures;
  bool hopeless = false;
  for (const std::size_t i : group_) {
    try {
      answer(i, given[i], move_mesh);
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

void Pass::ask(std::size_t i, const std::vector<coupling::Exchange>& known, bool move_mesh) {
  // The moved participant blocks until the mesh has moved, so the mover is asked first.
  const bool with_mover = move_mesh && schedule_.mover && partners_[i].name() == *schedule_.moved;
  if (with_mover) partners_.front().send({coupling::Op::solve, {}, guess_, 0, -1, ""});
  coupling::Command command{coupling::Op::solve, {}, links_->input(i, known), 0, -1, ""};
  partners_[i].send(command);
  taken_[i] = std::move(command.data);
}

void Pass::answer(std::size_t i, coupling::Exchange& given, bool move_mesh) {
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
    answered_anew_ = answered_anew_ || reply.anew;
  } catch (const SolveFailure&) {
    if (!mover_failed) throw;
  }
  if (mover_failed) throw SolveFailure(*mover_failed);
  require_finite_answer(i, given);
  answered_(i, taken_[i], given);
}

/// Called after the answer of `i`, for closed fluids.
void Pass::hold_volume(std::size_t i, std::vector<coupling::Exchange>& known) {
  volume_level_->loaded(i, taken_[i], known[i]);
  if (i != volume_level_->structures().back()) return;
  volume_level_->find(known, [&] {
    for (const std::size_t structure : volume_level_->structures()) {
      ask(structure, known, false);
      answer(structure, known[structure], false);
    }
  });
}

void Pass::visit(io::Archive& archive) {
  if (volume_level_) volume_level_->visit(archive, sides_);
  for (const Partner& partner : partners_)
    if (auto* foreign = dynamic_cast<ForeignStructure*>(partner.channel.get())) foreign->visit(archive);
}

}  // namespace couplet::coupler
