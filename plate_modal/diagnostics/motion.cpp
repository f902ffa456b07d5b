// SPDX-License-Identifier: Apache-2.0
#include "plate_modal/diagnostics/motion.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace couplet::plate {
namespace {

/// Steps per period for a resolved mode. The trapezoidal rule lengthens its period by (omega dt)^2/12: 3 %
/// with ten steps and 0.8 % with twenty, the recommended number.
constexpr double least_steps = 10, good_steps = 20;
/// Minimum number of samples: one jump in fewer steps gives no information about the load.
constexpr double least_samples = 16;
/// Minimum number of reversals for a load to count as a vibration.
constexpr double least_turns = 8;

}  // namespace

Motion::Motion(std::span<const double> omega) : modes_(omega.size()) {
  for (std::size_t m = 0; m < omega.size(); ++m) modes_[m].omega = omega[m];
  for (const double w : omega)
    if (w > 0 && longest_period_ == 0) longest_period_ = 2 * std::numbers::pi / w;
}

// Trapezoidal rule with the phase theta = 2 atan(omega dt/2) per step: an oscillation of amplitude A has the
// mid-step displacement A cos(theta/2) cos(phi) = -acceleration/omega^2. A mode that follows a slow load
// without inertia has no acceleration and is not seen here. Steps of half a period or more sample the
// oscillation at the same phases, with mid-steps at rest. There its ends, A sin(theta/2) sin(phi) from the
// middle, are used, less the motion by the load.
void Motion::accepted(const ModalState& before, const ModalState& after, std::span<const double> load,
                      double dt) {
  time_ += dt;
  ++steps_;
  for (std::size_t m = 0; m < modes_.size(); ++m) {
    Mode& mode = modes_[m];
    const double w = mode.omega;
    const double square = 0.5 * (before.q[m] * before.q[m] + after.q[m] * after.q[m]) * dt;
    if (w == 0) {
      rigid_ += square;
      continue;
    }
    const double middle = (after.v[m] - before.v[m]) / (dt * w * w), half = 0.5 * w * dt;
    double swing = middle * middle * (1 + half * half) * dt;
    if (half > 1) {
      const double ends = 0.5 * (after.q[m] - before.q[m] - (load[m] / (w * w) - mode.last_load));
      if (steps_ >= 2) swing = 0.5 * (swing + ends * ends * (1 + 1 / (half * half)) * dt);
    }
    follow(mode, 0.5 * (before.v[m] + after.v[m]), load[m] / (w * w), dt);
    mode.moved += square;
    mode.swung += swing;
    if (w * dt * least_steps <= 2 * std::numbers::pi * (1 + 1e-9)) continue;
    mode.coarse += swing;
    mode.longest_step = std::max(mode.longest_step, dt);
  }
}

/// A changing load as its static displacement. Steps with hardly any change (a constant load, a pulse that
/// has ended) give no information, because the mode is then free.
void Motion::follow(Mode& mode, double rate, double load, double dt) {
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
  mode.rate += rate * rate * dt;
  mode.rate_step += rate * rate * dt * dt * dt;
  mode.drive += change * change * dt;
  mode.driven += 1;
}

/// Near its own frequency a mode responds as 1/(omega^2 - load^2): an error e of omega gives the relative
/// error 2 e D, D the amplification over the static response.
void Motion::find_resonance(Evidence& e, double all) const {
  for (std::size_t m = 0; m < modes_.size(); ++m) {
    const Mode& mode = modes_[m];
    if (mode.omega == 0 || !(mode.drive > 0) || mode.driven < least_samples) continue;
    const double half = 0.5 * mode.omega * std::sqrt(mode.rate_step / mode.rate);
    const double error = 1 - std::atan(half) / half, amplification = std::sqrt(mode.rate / mode.drive);
    const double number = std::min(1.0, 2 * error * amplification) * std::sqrt(mode.moved / all);
    if (!(number > e.resonance_error || std::isnan(e.resonance_error))) continue;
    e.resonance_error = number;
    e.resonant_mode = int(m) + 1;
    e.amplification = amplification;
    e.resonant_step =
        2 * half / mode.omega * std::sqrt(0.2 * coarse_limit / std::max(2 * error * amplification, 1e-300));
  }
}

// Reversals alone would mistake noise for a vibration, the RMS change alone a jump.
void Motion::find_load(Evidence& e) const {
  double change = 0, square = 0, largest = 0;
  std::size_t first = 0;
  for (std::size_t m = 0; m < modes_.size(); ++m) {
    const Mode& mode = modes_[m];
    if (mode.omega == 0) continue;
    const double about_mean = mode.load_square - mode.load * mode.load / time_;
    change += mode.change;
    square += about_mean;
    if (about_mean > largest) largest = about_mean, first = m;
  }
  if (!(square > 0) || modes_[first].turns < least_turns) return;
  e.load_omega = std::min(std::sqrt(change / square), std::numbers::pi * modes_[first].turns / time_);
  e.load_over_last = e.load_omega / modes_.back().omega;
}

/// Integral of the square over mass and time (orthonormal modes). Rigid motions count by their round-off.
double Motion::displacement() const {
  double sum = 1e-12 * rigid_;
  for (const Mode& mode : modes_) sum += mode.moved;
  return sum;
}

Motion::Evidence Motion::evidence(bool at_end) const {
  Evidence e;
  const double all = displacement();
  if (!(all > 0) || (!at_end && time_ < 0.25 * longest_period_)) return e;
  double coarse = 0, above = 0;
  std::size_t worst = 0;
  for (std::size_t m = 0; m < modes_.size(); ++m) {
    const Mode& mode = modes_[m];
    coarse += mode.coarse;
    if (mode.coarse > modes_[worst].coarse) worst = m;
    if (mode.moved >= 1e-4 * all) e.last_mode_omega = mode.omega;
  }
  find_resonance(e, all);
  find_load(e);
  e.coarse_share = std::sqrt(coarse / all);
  if (coarse == 0) return e;
  e.coarse_mode = int(worst) + 1;
  e.steps_a_period = 2 * std::numbers::pi / (modes_[worst].omega * modes_[worst].longest_step);
  for (std::size_t m = modes_.size(); m-- > 0;) {
    above += modes_[m].swung;
    e.recommended_step = 2 * std::numbers::pi / (modes_[m].omega * good_steps);
    if (above > coarse_limit * coarse_limit * all) break;
    if (m > 0 && modes_[m - 1].omega == 0) break;
  }
  return e;
}

}  // namespace couplet::plate
