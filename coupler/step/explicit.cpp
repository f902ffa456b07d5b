// SPDX-License-Identifier: Apache-2.0
// Explicit (loose) coupling: one pass per step.
#include <algorithm>
#include <bit>
#include <limits>

#include "common/base/error.hpp"
#include "coupler/coupler.hpp"

namespace couplet::coupler {
namespace {

/// The response to the load is measured in steps 1 (to explain a failure), 4, 16, 64, ...
bool measures_response_in(GlobalIndex step) {
  const auto n = static_cast<std::uint64_t>(step);
  return n == 1 || (n >= 4 && std::has_single_bit(n) && std::countr_zero(n) % 2 == 0);
}

}  // namespace

FixedPointResult Coupler::single_pass(const coupling::Step& step) {
  FixedPointResult result;
  if (!has_history()) {
    result.x = result.image = first_pass();
  } else {
    result.x = guess(step.dt);
    result.image = pass(result.x);
    result.residual = worst(measure(result.x, result.image));
    // Sub-steps use linear input in time, which each additional pass would change.
    const bool repeats =
        pass_.schedule().sub_steps.empty() && std::ranges::none_of(pass_.partners(), &Partner::is_precice);
    if (repeats && !unknown_->parts().empty() && measures_response_in(step.number))
      measure_response(step, result);
  }
  result.iterations = 1;
  record_->monitor().iteration(step, 1, result.residual, std::numeric_limits<double>::quiet_NaN());
  return result;
}

/// A second pass shows how much of the motion returns through the load. A third one from `result.x` leaves the
/// participants as they were.
void Coupler::measure_response(const coupling::Step& step, FixedPointResult& result) {
  const long counted = iterations_;
  try {
    const Iterate again = pass(result.image);
    for (const auto& d : coupling_diagnostics_) d->returned(step.number, result.x, result.image, again);
  } catch (const SolveFailure&) {  // the step itself was solved
  }
  result.image = pass(result.x);
  iterations_ = counted;
}

}  // namespace couplet::coupler
