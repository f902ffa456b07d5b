// SPDX-License-Identifier: Apache-2.0
// What `method: auto` chooses.
#include <fmt/format.h>

#include <algorithm>

#include "common/log/log.hpp"
#include "common/parallel/collective.hpp"
#include "mesh_mover/mover.hpp"

namespace couplet::mesh_mover {
namespace {

// Times of a run at which the prescribed motions are tried.
constexpr int looks_ahead = 40;

}  // namespace

void Mover::use_barrier(const std::string& reason) {
  parameters_.method = Method::barrier;
  make_method();
  if (parallel::comm_rank(mesh_.comm) == 0) log::info("auto: method: barrier ({})", reason);
}

/// Looks ahead: the Laplacian moves the mesh to some times of the run.
void Mover::choose_method(double end) {
  if (!moving_.empty() && periodic_.empty())
    for (int i = 1; i <= looks_ahead; ++i) {
      step_ = {.time = 0, .dt = end * i / looks_ahead};
      displacement_ = method_->solve(prescribed({}));
      placed_ = false;
      place();
      const std::string refusal = guard_.refusal(moved_);
      if (refusal.empty()) continue;
      use_barrier(fmt::format("at t = {:.4g} s the prescribed motion with laplacian {}", step_.dt,
                              refusal.substr(0, refusal.find(". "))));
      break;
    }
  if (parameters_.method == Method::automatic) {
    make_method();
    if (parallel::comm_rank(mesh_.comm) == 0)
      log::info(
          "auto: method: laplacian (no prescribed motion inverts a cell); barrier from the first motion that does");
  }
  step_ = {};
  std::ranges::fill(displacement_, 0.0);
  placed_ = false;
}

/// Where the Laplacian's mesh is refused the barrier moves it, from now on.
void Mover::leave_laplacian(const coupling::Exchange& in) {
  place();
  const std::string refusal = guard_.refusal(moved_);
  if (refusal.empty() || !periodic_.empty()) return;  // no barrier across periodic patches
  use_barrier(fmt::format("the motion from t = {:.4g} s with laplacian {}", step_.time,
                          refusal.substr(0, refusal.find(". "))));
  displacement_ = method_->solve(prescribed(in));
  placed_ = false;
}

std::vector<effects::Coordinate> Mover::position() const {
  if (!least_jacobian_) return {};
  return {{"least scaled Jacobian", *least_jacobian_, 0, "mover-rotation", true}};
}

}  // namespace couplet::mesh_mover
