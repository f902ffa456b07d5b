// SPDX-License-Identifier: Apache-2.0
// What `method: auto` chooses.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "common/base/error.hpp"
#include "common/log/log.hpp"
#include "common/parallel/collective.hpp"
#include "mesh_mover/mover.hpp"

namespace couplet::mesh_mover {
namespace {

// Times of a run at which the prescribed motions are tried: one for five steps, so that looking ahead costs a fifth of moving.
constexpr int most_looks = 40;
constexpr double looks_per_step = 0.2;

}  // namespace

void Mover::tell_choice() const {
  if (parallel::comm_rank(mesh_.comm) == 0) log::info("auto: method: barrier ({})", reason_);
}

/// Looks ahead: the Laplacian moves the mesh to some times of the run.
void Mover::choose_method(const app::SimulationParameters& simulation) {
  if (!chooses_) {
    if (parameters_.method == Method::automatic && parallel::comm_rank(mesh_.comm) == 0)
      log::info("auto: method: laplacian (the barrier is not available with {})",
                incremental() ? "form: incremental" : "periodic patches");
    return make_method();
  }
  try {
    make_method();
  } catch (const Error& error) {  // on all ranks alike
    reason_ = error.what();
    reason_ = reason_.substr(0, reason_.find(". "));
  }
  const double steps = simulation.time_step > 0 ? simulation.end_time / simulation.time_step : most_looks;
  const int looks = static_cast<int>(std::clamp(std::ceil(looks_per_step * steps), 1.0, double(most_looks)));
  for (int i = 1; i <= looks && reason_.empty() && !moving_.empty(); ++i) {
    step_ = {.time = 0, .dt = simulation.end_time * i / looks};
    displacement_ = method_->solve(prescribed({}));
    const std::string refusal = place_and_judge();
    if (!refusal.empty())
      reason_ = fmt::format("at t = {:.4g} s the prescribed motion with laplacian {}", step_.dt,
                            refusal.substr(0, refusal.find(". ")));
  }
  step_ = {};
  std::ranges::fill(displacement_, 0.0);
  placed_ = false;
  ahead_ = !reason_.empty();
  if (!ahead_) return;
  parameters_.method = Method::barrier;
  make_method();
  tell_choice();
}

}  // namespace couplet::mesh_mover
