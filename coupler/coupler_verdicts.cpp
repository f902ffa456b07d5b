// SPDX-License-Identifier: Apache-2.0
// What a coupled run finds out about its own answer, in its midst and at its end.
#include <algorithm>

#include "common/log/finding.hpp"
#include "common/log/log.hpp"
#include "common/parallel/collective.hpp"
#include "coupler/coupler.hpp"

namespace couplet::coupler {
namespace {

/// Of the accepted state, of all that take a force [J]; NaN where one does not tell.
double energy_of_structures(const std::vector<Side>& sides, const std::vector<Partner>& partners) {
  double total = 0;
  for (std::size_t i = 0; i < sides.size(); ++i)
    if (std::ranges::find(sides[i].interface.takes, "N", &coupling::Interface::Datum::unit) !=
        sides[i].interface.takes.end())
      total += partners[i].report.energy;
  return total;
}

// Of the motion: a step that leaves more is no solution of the coupled problem.
constexpr double useless_residual = 0.5;

}  // namespace

void Coupler::report_unconverged(double time) {
  const double residual = last_.residual.relative;
  const std::string text = fmt::format(
      "t = {:g} s: coupling: relative residual = {:.2e} (limit {:.1e}){} after {} iterations: the step is accepted "
      "unconverged",
      time, residual, parameters_.convergence.relative, absolute_too(last_.residual, parameters_.convergence),
      last_.iterations);
  if (worst_accepted_ > 0 && residual < 10 * worst_accepted_) {
    log::info("{}", text);
    return;
  }
  worst_accepted_ = residual;
  log::finding(parallel::comm_rank(comm_),
               {.id = "unconverged-step",
                .severity = residual < useless_residual ? base::Severity::warning : base::Severity::wrong,
                .number = residual,
                .limit = parameters_.convergence.relative,
                .sentence = text,
                .advice = "raise `convergence.max-iterations`, or leave `at-max-iterations: accept` out"});
}

void Coupler::watch(double time, const std::vector<SideBalance>& balances) {
  double given = 0, taken = 0;
  for (const SideBalance& side : balances) (side.gives ? given : taken) += side.balance.work;
  std::optional<std::string> reason =
      oscillation_guard_.accepted(unknown_->motion(last_.image), last_dt_, scheme_.now());
  const bool swings = reason.has_value();
  if (!balances.empty() && mechanics_->knows_work()) {
    work_guard_.energy(energy_of_structures(sides_, partners_));
    const auto parted = work_guard_.accepted(given, taken, scheme_.now());
    if (!reason) reason = parted;
  }
  for (std::string& still : still_guard_->accepted(given_, taken_))
    log::finding(
        parallel::comm_rank(comm_),
        {.id = "structure-at-rest", .sentence = fmt::format("t = {:g} s: {}", time, std::move(still))});
  for (log::Finding& finding : data_guard_->accepted(given_, last_dt_)) {
    finding.sentence = fmt::format("t = {:g} s: {}", time, finding.sentence);
    log::finding(parallel::comm_rank(comm_), finding);
  }
  audit_->loads(given_);
  audit_->tell(parameters_, time);
  if (!reason || !diverged_.empty()) return;
  if (parameters_.on_divergence == CouplingParameters::OnDivergence::stop)
    diverged_ = *reason;
  else if (!warned_)
    log::finding(parallel::comm_rank(comm_), {.id = swings ? "interface-oscillation" : "interface-work-grows",
                                              .severity = base::Severity::wrong,
                                              .sentence = fmt::format("t = {:g} s: {}", time, *reason)});
  warned_ = true;
}

/// `problem`: why the run stopped before its end; then nothing is said of what its answer errs by.
void Coupler::finalise(const std::string& problem) {
  enter_(app::Phase::finalise, {});
  log::info("{}", monitor_->summary(loop_.halvings()));
  if (const std::string waiting = monitor_->waiting(partners_, schedule_); !waiting.empty())
    log::info("{}", waiting);
  tell_work();
  audit_->tell_at_end(parameters_, problem.empty());
  std::vector<coupling::NamedErrors> parts = finalise_all(everyone(), problem);
  if (simulation_.error_estimate && problem.empty()) tell_errors(std::move(parts));
  if (const std::string where = effects::position_sentence(position()); !where.empty())
    log::info("{}", where);
}

std::vector<effects::Coordinate> Coupler::position() const {
  if (!schedule_.iterates) return audit_->position(parameters_);
  if (!(steps() > 0)) return {};
  return {{"passes per step", double(iterations()) / double(steps()),
           double(parameters_.convergence.max_iterations), "strong-robin"}};
}

void Coupler::tell_work() const {
  const WorkGuard::Verdict v =
      work_guard_.verdict(parameters_.mapping.type == MappingParameters::Type::nearest, !schedule_.iterates);
  if (v.text.empty()) return;
  if (v.sound) return log::info("{}", v.text);
  log::finding(parallel::comm_rank(comm_),
               {.id = "interface-work",
                .severity = v.useless ? base::Severity::wrong : base::Severity::warning,
                .number = v.part,
                .limit = WorkGuard::sound_part,
                .sentence = v.text});
}

void Coupler::tell_errors(std::vector<coupling::NamedErrors> participants) {
  coupling::ErrorParts mine = audit_->parts(parameters_);
  if (errors_) mine.coupling = errors_->over_size();
  if (mine.known() || !mine.omittable.empty()) participants.push_back({"coupling", std::move(mine)});
  found_ = coupling::largest(participants);
  for (const std::string& sentence : coupling::error_sentences(participants)) log::info("{}", sentence);
  if (const auto finding = coupling::worthless(participants))
    log::finding(parallel::comm_rank(comm_), *finding);
  if (!schedule_.iterates) log::info("{}", lag_ ? lag_->sentence(participants) : LagEstimate::not_possible());
}

app::StepFailure Coupler::cause_of(const std::string& reported) const {
  // Without the advice that goes with it: a smaller step or another mesh would not help.
  const std::string met = reported.substr(0, reported.find(". Try ") + 1);
  const auto then = [&](const std::string& cause) {
    return cause + " Thereupon " + (met.empty() ? reported : met);
  };
  const AccelerationParameters& by = parameters_.acceleration;
  const bool constant = by.type == AccelerationParameters::Type::constant;
  if (schedule_.iterates) {
    if (const auto grew = iteration_guard_.suspects(constant ? by.initial_relaxation : 0))
      return {then(*grew), !constant};
  } else if (const auto returns = audit_->suspects(parameters_)) {
    return {then(*returns), false};
  }
  // What swings already is not saved by halving.
  auto swings = oscillation_guard_.suspects(scheme_.now());
  if (!swings && mechanics_->knows_work()) swings = work_guard_.suspects(scheme_.now());
  if (swings && parameters_.on_divergence == CouplingParameters::OnDivergence::stop)
    return {then(*swings), false};
  return app::StepFailure(reported + data_guard_->silent());
}

}  // namespace couplet::coupler
