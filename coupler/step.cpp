// SPDX-License-Identifier: Apache-2.0
// One step: its scheme, and the iteration of its passes.
#include <limits>
#include <utility>

#include "common/base/error.hpp"
#include "common/log/log.hpp"
#include "coupler/coupler.hpp"

namespace couplet::coupler {

std::optional<app::StepFailure> Coupler::attempt(const coupling::Step& step) {
  if (!diverged_.empty()) return app::StepFailure(diverged_, false);
  auto failure = attempt_once(step);
  // Only what the iteration itself may have failed of: no scheme mends a first pass.
  if (!failure || !failure->halving_helps || passes_ < 2 || !scheme_.failed()) return failure;
  auto learnt = std::move(accelerator_);
  start_acceleration();
  if (attempt_once(step)) {
    scheme_.withdraw();
    accelerator_ = std::move(learnt);
    return failure;
  }
  SchemeChoice::tell(step.time, "the semi-implicit step failed: " + failure->reason);
  return {};
}

std::optional<app::StepFailure> Coupler::attempt_once(const coupling::Step& step) {
  enter_(app::Phase::begin_step, step.time);
  for (Partner& p : partners_) p.seconds = 0;
  data_guard_->start_step();
  scheme_.start_step();
  passes_ = 0;
  try {
    solve(step);
  } catch (const SchemeFailure& failure) {
    return app::StepFailure(failure.what(), false);
  } catch (const SolveFailure& failure) {
    return cause_of(failure.what());
  }
  return {};
}

void Coupler::solve(const coupling::Step& step) {
  coupling::Step begun = step;
  begun.waveform = schedule_.waveform;
  begun.scheme = scheme_.now();
  look_at_lag(begun);
  ask_all(everyone(), {coupling::Op::begin_step, begun, {}, 0, -1, ""});
  enter_(app::Phase::solve, step.time);
  if (volume_level_) volume_level_->start_step(step.dt);
  bool first = true;
  std::vector<coupling::Exchange> outputs;
  const auto pass_from = [&](std::vector<coupling::Exchange> known) {
    give_back(std::move(outputs));
    const bool shows_times = first && schedule_.iterates && unknown_->asked_within();
    outputs = pass(std::move(known), std::exchange(first, false));
    if (shows_times && unknown_->adopt_times(outputs))  // what was learnt was of other unknowns
      start_acceleration();
  };
  const FixedPointMap map = [&](const Iterate& x) {
    std::vector<coupling::Exchange> known(partners_.size());
    unknown_->scatter(x, known);
    pass_from(std::move(known));
    if (answered_anew_) map_changed();
    return unknown_->gather(outputs);
  };
  const bool begins =
      history_.now.unknown.empty() && history_.now.rider.empty() && !unknown_->parts().empty();
  if (begins || unknown_->parts().empty()) {
    // Data that nobody has given yet are missing from this first pass.
    pass_from(std::vector<coupling::Exchange>(partners_.size()));
    if (!unknown_->scaled()) unknown_->scale(outputs);
    last_ = {unknown_->gather(outputs), unknown_->gather(outputs), {}, 1};
  }
  if (!begins) last_.x = unknown_->begin_step(predict(*unknown_, history_, step.dt, schedule_.predictor));
  if (!schedule_.iterates) {
    if (!begins && !unknown_->parts().empty()) {
      pass_once(step, map);
    }
    monitor_->iteration(step, 1, last_.residual, std::numeric_limits<double>::quiet_NaN());
  } else if (!unknown_->parts().empty()) {
    const bool constant = parameters_.acceleration.type == AccelerationParameters::Type::constant;
    iteration_guard_.start_step();
    if (errors_) errors_->start_step();
    const IterationObserver observer = [&](int k, const Residual& residual, double omega) {
      monitor_->iteration(step, k, residual, omega);
      if (errors_) errors_->pass(residual);
      if (!converged(residual, parameters_.convergence))
        iteration_guard_.pass(residual.absolute, omega, constant);
    };
    const ResidualMeasure measure = [&](const Iterate& x, const Iterate& image) {
      return unknown_->measure(x, image);
    };
    std::optional<Iterate> seen = begins ? std::nullopt : look_within(map);
    const FixedPointMap on = [&](const Iterate& x) { return seen ? *std::exchange(seen, {}) : map(x); };
    last_ = solve_fixed_point(std::move(last_.x), seen ? on : map, measure, parameters_.convergence,
                              *accelerator_, observer);
    if (!last_.converged) report_unconverged(step.time);
  }
  give_back(std::exchange(given_, std::move(outputs)));
  last_dt_ = step.dt;
}

void Coupler::map_changed() {
  scheme_.renewed();
  if (accelerator_) accelerator_->map_changed();
}

void Coupler::start_acceleration() {
  if (schedule_.iterates) accelerator_ = make_accelerator(parameters_.acceleration, comm_);
}

}  // namespace couplet::coupler
