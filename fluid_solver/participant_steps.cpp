// SPDX-License-Identifier: Apache-2.0
// What a participant tells of its sub-steps.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "common/diagnostics/finding.hpp"
#include "common/log/log.hpp"
#include "fluid_solver/participant.hpp"

namespace couplet::fluid {
namespace {

// Sub-steps of a step over those of the step last told in the log, or the other way round.
constexpr double most_times_as_many = 2;
}  // namespace

/// One line where a step took many more parts than when it was last told, or many fewer, with the cell that
/// asks for them.
template <int D>
void FluidParticipant<D>::tell_sub_steps() {
  const int now = fluid_->statistics().sub_steps;
  const bool as_told =
      now < most_times_as_many * told_sub_steps_ && told_sub_steps_ < most_times_as_many * now;
  if (as_told) return;
  told_sub_steps_ = now;
  const double end = step_.time + step_.dt;
  if (const auto own = fluid_->parameters().time_step) {
    if (parallel::comm_rank(mesh_.comm) == 0)
      log::info("t = {:.6g} s: {} sub-steps of {:.3g} s: time-step is {:.3g} s", end, now, step_.dt / now,
                *own);
    return;
  }
  const StepLimiter limiter = fluid_->sizes().limiter(fluid_->state());
  if (parallel::comm_rank(mesh_.comm) == 0)
    log::info(
        "t = {:.6g} s: {} sub-steps of {:.3g} s; {} in cell {} at ({:.4g}, {:.4g}, {:.4g}) m limits them to "
        "{:.3g} s, of which {:.0f} % are used",
        end, now, step_.dt / now, limiter.friction ? "friction" : "convection", limiter.cell,
        limiter.place.x(), limiter.place.y(), limiter.place.z(), limiter.limit,
        100 * fluid_->parameters().safety_factor);
}

template void FluidParticipant<2>::tell_sub_steps();
template void FluidParticipant<3>::tell_sub_steps();

}  // namespace couplet::fluid
