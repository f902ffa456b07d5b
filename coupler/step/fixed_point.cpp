// SPDX-License-Identifier: Apache-2.0
// Semi-implicit and implicit coupling: x = H(x) by accelerated passes. The two schemes differ only in what a pass H
// repeats (Pass, Step::scheme).
#include <utility>

#include "common/base/error.hpp"
#include "coupler/coupler.hpp"

namespace couplet::coupler {

FixedPointResult Coupler::iterate(const coupling::Step& step) {
  const ConvergenceParameters& limits = parameters_.convergence;
  accelerator_->start_step();
  const bool predicts = has_history();
  Iterate x = predicts ? guess(step.dt) : first_pass();
  Residual residual;
  for (int k = 1; k <= limits.max_iterations; ++k) {
    Iterate image = pass(x);
    if (k == 1 && predicts) x = unknown_->hold_samples(std::move(x));
    const std::vector<Residual> residuals = measure(x, image);
    residual = worst(residuals);
    observe(step, k, residuals);
    const bool converged = has_converged(residuals, limits);
    if (converged || (k == limits.max_iterations && limits.accepts_at_maximum)) {
      accelerator_->accept(x, image);
      return {std::move(x), std::move(image), residual, k, converged};
    }
    x = accelerator_->next(std::move(x), image);
  }
  throw SolveFailure(
      "the coupling did not converge in {} iterations: the relative residual is {:.2e} (tolerance {:.1e}).",
      limits.max_iterations, residual.relative, limits.relative);
}

/// Records a pass. Throws SolveFailure if the iteration diverges (IterationGrowth).
void Coupler::observe(const coupling::Step& step, int number, const std::vector<Residual>& residuals) {
  const double omega = accelerator_->relaxation();
  record_->monitor().iteration(step, number, worst(residuals), omega);
  for (const auto& d : coupling_diagnostics_) d->passed(residuals, omega);
}

/// H(x): one pass from the data x to the same data anew.
Iterate Coupler::pass(const Iterate& x) {
  std::vector<coupling::Exchange> data(pass_.partners().size());
  unknown_->scatter(x, data);
  return pass_from(std::move(data));
}

Iterate Coupler::pass_from(std::vector<coupling::Exchange> data) {
  const bool first = pass_.is_first();
  const std::vector<coupling::Exchange>& given = pass_(std::move(data));
  ++iterations_;
  unknown_->scale(given);
  if (first && accelerator_ && unknown_->adopt_sample_times(given)) {
    start_acceleration();
    accelerator_->start_step();
  }
  if (pass_.renewed_prediction()) {
    scheme_.count_renewal();
    if (accelerator_) accelerator_->map_changed();
  }
  return unknown_->gather(given);
}

/// Prediction from the accepted steps, constant within the step.
Iterate Coupler::guess(double dt) {
  return unknown_->start_step(predict(*unknown_, history_, dt, pass_.schedule().predictor));
}

std::vector<Residual> Coupler::measure(const Iterate& x, const Iterate& image) const {
  return unknown_->measure(x, image, history_.now, parameters_.convergence.least_change());
}

}  // namespace couplet::coupler
