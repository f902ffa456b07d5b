// SPDX-License-Identifier: Apache-2.0
// One coupled step: predict, pass, accelerate, converge, accept.
#include <bit>
#include <limits>
#include <utility>

#include "common/base/error.hpp"
#include "coupler/coupler.hpp"

namespace couplet::coupler {
namespace {

/// Explicit coupling examines its response in more passes in steps 1 (to explain a failure), 4, 16, 64, ...
bool looks_at(GlobalIndex step) {
  const auto n = static_cast<std::uint64_t>(step);
  return n == 1 || (n >= 4 && std::has_single_bit(n) && std::countr_zero(n) % 2 == 0);
}

}  // namespace

/// Solves x = H(x) for the step from t^n to t^n + dt. Participants keep their state n.
void Coupler::solve(const coupling::Step& step) {
  Unknown& unknown = known_->unknown;
  coupling::Step begun = step;
  begun.waveform = pass_.schedule().waveform;
  begun.scheme = scheme_.now();
  pass_.ask_all({coupling::Op::begin_step, begun, {}, 0, -1, ""});
  enter_(app::Phase::solve, step.time);
  if (VolumeLevel* level = pass_.volume_level()) level->start_step(step.dt);

  bool first = true;
  std::vector<coupling::Exchange> outputs;
  const auto pass_from = [&](std::vector<coupling::Exchange> known) {
    pass_.give_back(std::move(outputs));
    const bool shows_times = first && pass_.schedule().iterates && unknown.asked_within();
    outputs = pass_(std::move(known), std::exchange(first, false), scheme_.now());
    ++iterations_;
    unknown.scale(outputs);
    if (shows_times && unknown.adopt_times(outputs)) start_acceleration();
  };
  const FixedPointMap map = [&](const Iterate& x) {
    std::vector<coupling::Exchange> known(pass_.partners().size());
    unknown.scatter(x, known);
    pass_from(std::move(known));
    if (pass_.answered_anew()) {
      scheme_.renewed();
      if (accelerator_) accelerator_->map_changed();
    }
    return unknown.gather(outputs);
  };

  const bool iterates_on_data = !unknown.parts().empty();
  const bool begins = iterates_on_data && history_.now.unknown.empty() && history_.now.rider.empty();
  if (begins || !iterates_on_data) {
    // Data that have not been given yet are missing from the first pass.
    pass_from(std::vector<coupling::Exchange>(pass_.partners().size()));
    last_ = {unknown.gather(outputs), unknown.gather(outputs), {}, 1};
  }
  if (!begins) last_.x = unknown.begin_step(predict(unknown, history_, step.dt, pass_.schedule().predictor));
  if (iterates_on_data && pass_.schedule().iterates)
    last_ = iterate(step, std::move(last_.x), map);
  else if (iterates_on_data && !begins)
    last_ = pass_once(begun, std::move(last_.x), map);
  if (!pass_.schedule().iterates)
    known_->record.monitor().iteration(step, 1, last_.residual, std::numeric_limits<double>::quiet_NaN());
  pass_.set_given(std::move(outputs));
  last_dt_ = step.dt;
}

/// Iterates passes and accelerated guesses until all residuals are below their bounds.
FixedPointResult Coupler::iterate(const coupling::Step& step, Iterate guess, const FixedPointMap& map) {
  Unknown& unknown = known_->unknown;
  for (const auto& d : known_->diagnostics) d->begin_step();
  const IterationObserver observer = [&](int k, const std::vector<Residual>& residuals, double omega) {
    known_->record.monitor().iteration(step, k, worst(residuals), omega);
    for (const auto& d : known_->diagnostics) d->passed(residuals, omega);
  };
  const ResidualMeasure measure = [&](const Iterate& x, const Iterate& image) {
    return unknown.measure(x, image, history_.now, parameters_.convergence.least_change());
  };
  // Values within the step are iterated at the times found in the first pass.
  std::optional<Iterate> seen;
  const bool begins = history_.now.unknown.empty() && history_.now.rider.empty();
  if (!begins && unknown.asked_within()) {
    seen = map(guess);
    guess = unknown.held(unknown.ends(std::move(guess)));
  }
  const FixedPointMap after_first = [&](const Iterate& x) {
    return seen ? *std::exchange(seen, {}) : map(x);
  };
  return solve_fixed_point(std::move(guess), after_first, measure, parameters_.convergence, *accelerator_,
                           observer);
}

/// Performs a step of explicit coupling. Results of additional passes only go to the diagnostics.
FixedPointResult Coupler::pass_once(const coupling::Step& step, Iterate guess, const FixedPointMap& map) {
  FixedPointResult result;
  result.x = std::move(guess);
  result.image = map(result.x);
  result.residual = worst(
      known_->unknown.measure(result.x, result.image, history_.now, parameters_.convergence.least_change()));
  result.iterations = 1;
  // Sub-steps use linear input in time, which each additional pass would change.
  if (step.scheme != coupling::Scheme::explicit_ || !pass_.schedule().sub_steps.empty() ||
      !looks_at(step.number))
    return result;
  try {
    const Iterate again = map(result.image);
    for (const auto& d : known_->diagnostics) d->returned(step.number, result.x, result.image, again);
  } catch (const SolveFailure&) {  // the step has its answer without this look
  }
  result.image = map(result.x);
  iterations_ -= 2;
  return result;
}

/// Makes the step state n.
void Coupler::accept(double time, int output) {
  Unknown& unknown = known_->unknown;
  enter_(app::Phase::accept, {});
  pass_.ask_all({coupling::Op::accept_step, {}, {}, time, output, ""});
  enter_(app::Phase::accept, time);
  if (unknown.has_within()) last_.image = unknown.ends(std::move(last_.image));
  known_->record.balance();
  diagnostics_.accepted(time);
  history_.accepted(last_.image, last_dt_, pass_.schedule().predictor);
  if (VolumeLevel* level = pass_.volume_level()) level->accept(pass_.given());
  known_->record.accepted(time, output, pass_.volume_level());
  if (scheme_.accepted(time)) start_acceleration();
}

}  // namespace couplet::coupler
