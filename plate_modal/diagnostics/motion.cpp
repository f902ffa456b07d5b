// SPDX-License-Identifier: Apache-2.0
#include "plate_modal/diagnostics/motion.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "common/io/checkpoint.hpp"
#include "plate_modal/diagnostics/view.hpp"

namespace couplet::plate {
namespace {

/// Minimum number of reversals for a load to count as a vibration.
constexpr double least_turns = 8;

/// Adds each step to the motion, which others read.
class MotionOfModes final : public diagnostics::Diagnostic {
 public:
  MotionOfModes(const PlateView& view, std::shared_ptr<Motion> motion)
      : view_(view), motion_(std::move(motion)) {}
  void observe(diagnostics::Report&) override {
    motion_->accepted(view_.before, view_.state, view_.oscillators.load(), view_.step.dt);
  }
  void visit(io::Archive& archive) override { archive.common("motion", *motion_); }

 private:
  PlateView view_;
  std::shared_ptr<Motion> motion_;
};

}  // namespace

Motion::Motion(std::span<const double> omega) : modes_(omega.size()) {
  for (std::size_t m = 0; m < omega.size(); ++m) modes_[m].omega = omega[m];
  for (const double w : omega)
    if (w > 0 && longest_period_ == 0) longest_period_ = 2 * std::numbers::pi / w;
}

void Motion::accepted(const ModalState& before, const ModalState& after, std::span<const double> load,
                      double dt) {
  time_ += dt;
  ++steps_;
  for (std::size_t m = 0; m < modes_.size(); ++m) {
    Mode& mode = modes_[m];
    if (mode.omega == 0) continue;
    follow(mode, load[m] / (mode.omega * mode.omega), dt);
    mode.moved += 0.5 * (before.q[m] * before.q[m] + after.q[m] * after.q[m]) * dt;
  }
}

/// A changing load as its static displacement. Steps with hardly any change (a constant load, a pulse that
/// has ended) give no information.
void Motion::follow(Mode& mode, double load, double dt) const {
  // Round-off of a constant load is no change.
  const double moved = load - mode.last_load;
  const double signed_change = std::abs(moved) < 1e-9 * std::abs(load) ? 0 : moved / dt;
  const double change = std::abs(signed_change);
  mode.last_load = load;
  if (steps_ < 2) return;
  mode.load += load * dt;
  mode.load_square += load * load * dt;
  mode.change += change * change * dt;
  mode.largest_change = std::max(mode.largest_change, change);
  if (!(change > 0.05 * mode.largest_change)) return;
  if (signed_change * mode.last_change < 0) mode.turns += 1;
  mode.last_change = signed_change;
}

// Reversals alone would mistake noise for a vibration, the RMS change alone a jump.
Motion::LoadFrequency Motion::load_frequency(bool at_end) const {
  double moved = 0, change = 0, square = 0, largest = 0;
  std::size_t first = 0;
  for (std::size_t m = 0; m < modes_.size(); ++m) {
    const Mode& mode = modes_[m];
    if (mode.omega == 0) continue;
    const double about_mean = mode.load_square - mode.load * mode.load / time_;
    moved += mode.moved;
    change += mode.change;
    square += about_mean;
    if (about_mean > largest) largest = about_mean, first = m;
  }
  if (!(moved > 0) || (!at_end && time_ < 0.25 * longest_period_)) return {};
  if (!(square > 0) || modes_[first].turns < least_turns) return {};
  const double omega = std::min(std::sqrt(change / square), std::numbers::pi * modes_[first].turns / time_);
  return {omega, omega / modes_.back().omega};
}

diagnostics::Made motion_of_modes(const RunOfPlate& run) {
  return run.motion ? std::make_shared<MotionOfModes>(run.view, run.motion) : nullptr;
}

}  // namespace couplet::plate
