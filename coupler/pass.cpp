// SPDX-License-Identifier: Apache-2.0
// One pass through the group.
#include "common/base/error.hpp"
#include "coupler/coupler.hpp"
#include "coupler/judge/places.hpp"

namespace couplet::coupler {

void Coupler::ask(std::size_t i, const std::vector<coupling::Exchange>& known, bool move_mesh) {
  // The moved one blocks until the mesh has been moved: the mover's command goes out first.
  const bool with_mover = move_mesh && schedule_.mover && partners_[i].name() == *schedule_.moved;
  if (with_mover) partners_.front().send({coupling::Op::solve, {}, guess_, 0, -1, ""});
  coupling::Command command{coupling::Op::solve, {}, links_->input(i, known), 0, -1, ""};
  partners_[i].send(command);
  taken_[i] = std::move(command.data);
}

void Coupler::answer(std::size_t i, coupling::Exchange& given, bool move_mesh) {
  const bool with_mover = move_mesh && schedule_.mover && partners_[i].name() == *schedule_.moved;
  // A failed motion makes the moved one fail too; the mover knows the reason. Both replies are always taken.
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
  require_finite(comm_, given, sides_[i].interface, sides_[i].interface.gives, partners_[i].name());
  data_guard_->answered(i, taken_[i], given);
}

void Coupler::exchange_initial_values() {
  for (std::size_t i = 0; i < partners_.size(); ++i) {
    given_[i] = std::move(partners_[i].initial);
    require_finite(comm_, given_[i], sides_[i].interface, sides_[i].interface.gives, partners_[i].name());
  }
  const std::vector<coupling::Exchange> initial = given_;
  for (std::size_t i = 0; i < partners_.size(); ++i) {
    if (initial[i].empty()) continue;
    partners_[i].send({coupling::Op::start, {}, links_->input(i, initial), 0, -1, ""});
    partners_[i].receive();
  }
  if (unknown_->complete(given_) || unknown_->start_at_rest(given_)) history_.now = unknown_->gather(given_);
}

/// After `i` has answered, where fluids are closed.
void Coupler::hold_volume(std::size_t i, std::vector<coupling::Exchange>& known) {
  volume_level_->loaded(i, taken_[i], known[i]);
  if (i != volume_level_->structures().back()) return;
  volume_level_->find(known, [&] {
    for (const std::size_t structure : volume_level_->structures()) {
      ask(structure, known, false);
      answer(structure, known[structure], false);
    }
  });
}

/// What the mover gets: the motion that is known before anybody has answered in this pass.
void Coupler::guess_motion(const std::vector<coupling::Exchange>& known, bool first) {
  if (first || !schedule_.mesh_on_guess) guess_ = links_->input(0, known);
}

std::vector<coupling::Exchange> Coupler::pass(std::vector<coupling::Exchange> known, bool first) {
  const bool move_mesh = schedule_.mover && (first || scheme_.now() != coupling::Scheme::semi_implicit);
  if (move_mesh) guess_motion(known, first);
  ++iterations_;
  ++passes_;
  answered_anew_ = false;
  if (!schedule_.side_by_side) {
    for (const std::size_t i : group_) {
      ask(i, known, move_mesh);
      answer(i, known[i], move_mesh);
      if (volume_level_) hold_volume(i, known);
    }
    return known;
  }
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

/// Tries a step half as long, two passes, which are forgotten; pass_once() has the whole one.
void Coupler::look_at_lag(coupling::Step step) {
  half_.reset();
  if (!lag_ || history_.now.rider.empty() || !CouplingAudit::looks_at(step.number)) return;
  step.dt /= 2;
  std::vector<coupling::Exchange> outputs;
  bool first = true;
  const auto answer_to = [&](const Iterate& x) {
    std::vector<coupling::Exchange> known(partners_.size());
    unknown_->scatter(x, known);
    give_back(std::move(outputs));
    outputs = pass(std::move(known), std::exchange(first, false));
    --iterations_;
    return unknown_->gather(outputs);
  };
  try {
    ask_all(everyone(), {coupling::Op::begin_step, step, {}, 0, -1, ""});
    LagEstimate::Look look;
    look.x = predict(*unknown_, history_, step.dt, schedule_.predictor);
    look.image = answer_to(look.x);
    look.again = answer_to(look.image);
    half_ = std::move(look);
  } catch (const SolveFailure&) {
    return;  // nothing is learnt; why the step itself fails is said there
  }
  give_back(std::move(outputs));
}

std::optional<Iterate> Coupler::look_within(const FixedPointMap& map) {
  if (!unknown_->asked_within()) return {};
  Iterate image = map(last_.x);
  last_.x = unknown_->held(unknown_->ends(std::move(last_.x)));
  return image;
}

void Coupler::pass_once(const coupling::Step& step, const FixedPointMap& map) {
  last_.image = map(last_.x);
  last_.residual = worst(unknown_->measure(last_.x, last_.image));
  last_.iterations = 1;
  // Not where sub-steps see a line through what was given: each pass would bend it.
  if (step.scheme != coupling::Scheme::explicit_ || !schedule_.sub_steps.empty() ||
      !CouplingAudit::looks_for_causes_at(step.number))
    return;
  const bool at_start = !CouplingAudit::looks_at(step.number);
  try {
    const Iterate again = map(last_.image);
    const Residual returned = worst(unknown_->measure(last_.image, again));
    if (at_start)
      audit_->returned_at_start(last_.residual, returned);
    else
      audit_->returned(last_.residual, returned);
    if (half_) lag_->looked({last_.x, last_.image, again}, *half_, step.dt);
  } catch (const SolveFailure&) {  // the step has its answer without this look
  }
  last_.image = map(last_.x);  // the step is what it is without this look
  iterations_ -= 2;            // nor are these its passes
}

}  // namespace couplet::coupler
