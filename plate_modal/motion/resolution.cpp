// SPDX-License-Identifier: Apache-2.0
#include "plate_modal/motion/resolution.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace couplet::plate {
namespace {

/// Steps a period from which a mode counts as resolved: the trapezoidal rule makes its period longer by
/// (omega dt)^2 / 12, 3 % with ten and 0.8 % with twenty, which is what is recommended.
constexpr double least_steps = 10, good_steps = 20;
/// The share of coarse modes that matters: docs/plate.md; effect_cards.cpp judges by the same number.
constexpr double coarse_limit = 0.1;
/// An impact that moves less of the energy is none to speak of (a structure that rests on its seat trembles).
constexpr double least_work = 0.02;
/// One jump among fewer steps says nothing about the load.
constexpr double least_samples = 16;
/// A load that has turned less often is no vibration.
constexpr double least_turns = 8;

enum Sum { time, rigid, impact_share, steps_, impact_time, load_apart, load_size, load_samples, n_sums };

}  // namespace

Resolution::Resolution(std::span<const double> omega)
    : omega_(omega.begin(), omega.end()),
      moved_(omega.size(), 0),
      swung_(moved_),
      coarse_(moved_),
      longest_step_(moved_),
      rate_(moved_),
      drive_(moved_),
      rate_step_(moved_),
      driven_(moved_),
      last_load_(moved_),
      largest_change_(moved_),
      load_(moved_),
      load_square_(moved_),
      change_(moved_),
      turns_(moved_),
      last_change_(moved_),
      sums_(n_sums, 0) {
  for (const double w : omega_)
    if (w > 0 && longest_period_ == 0) longest_period_ = 2 * std::numbers::pi / w;
}

// Trapezoidal rule, phase theta = 2 atan(omega dt / 2) a step: a swing of amplitude A has in the middle of a step
// the displacement A cos(theta / 2) cos(phi) = - acceleration / omega^2. A mode that follows a slow load without
// inertia has no acceleration, and nothing is seen of it here. Steps of half a period and more meet the swing at the same
// phases again and again, its middle at rest: there its ends, A sin(theta / 2) sin(phi) apart from the middle, count as
// much, less what the load itself moves them.
void Resolution::accepted(const ModalState& before, const ModalState& after, std::span<const double> load,
                          double dt) {
  sums_[time] += dt;
  sums_[steps_] += 1;
  for (std::size_t m = 0; m < omega_.size(); ++m) {
    const double w = omega_[m];
    const double square = 0.5 * (before.q[m] * before.q[m] + after.q[m] * after.q[m]) * dt;
    if (w == 0) {
      sums_[rigid] += square;
      continue;
    }
    const double middle = (after.v[m] - before.v[m]) / (dt * w * w), half = 0.5 * w * dt;
    double swing = middle * middle * (1 + half * half) * dt;
    if (half > 1) {
      const double ends = 0.5 * (after.q[m] - before.q[m] - (load[m] / (w * w) - last_load_[m]));
      if (sums_[steps_] >= 2) swing = 0.5 * (swing + ends * ends * (1 + 1 / (half * half)) * dt);
    }
    follow(m, 0.5 * (before.v[m] + after.v[m]), load[m] / (w * w), dt);
    moved_[m] += square;
    swung_[m] += swing;
    if (w * dt * least_steps <= 2 * std::numbers::pi * (1 + 1e-9)) continue;
    coarse_[m] += swing;
    longest_step_[m] = std::max(longest_step_[m], dt);
  }
}

/// A load that changes, as the displacement that it would make without inertia. Steps in which it hardly does (a
/// constant load, a pulse that is over) say nothing: the mode is free then.
void Resolution::follow(std::size_t m, double rate, double load, double dt) {
  // Rounding of a load that stays is no change.
  const double moved = load - last_load_[m];
  const double signed_change = std::abs(moved) < 1e-9 * std::abs(load) ? 0 : moved / dt;
  const double change = std::abs(signed_change);
  last_load_[m] = load;
  if (sums_[steps_] < 2) return;
  load_[m] += load * dt;
  load_square_[m] += load * load * dt;
  change_[m] += change * change * dt;
  largest_change_[m] = std::max(largest_change_[m], change);
  if (!(change > 0.05 * largest_change_[m])) return;
  if (signed_change * last_change_[m] < 0) turns_[m] += 1;
  last_change_[m] = signed_change;
  rate_[m] += rate * rate * dt;
  rate_step_[m] += rate * rate * dt * dt * dt;
  drive_[m] += change * change * dt;
  driven_[m] += 1;
}

/// Near its own frequency a mode answers as 1 / (omega^2 - load^2): an error e of omega is 2 e D of the answer, D the
/// amplification over what the load does without inertia.
void Resolution::find_resonance(StepEvidence& e, double all) const {
  for (std::size_t m = 0; m < omega_.size(); ++m) {
    if (omega_[m] == 0 || !(drive_[m] > 0) || driven_[m] < least_samples) continue;
    const double half = 0.5 * omega_[m] * std::sqrt(rate_step_[m] / rate_[m]);
    const double error = 1 - std::atan(half) / half, amplification = std::sqrt(rate_[m] / drive_[m]);
    const double number = std::min(1.0, 2 * error * amplification) * std::sqrt(moved_[m] / all);
    if (!(number > e.resonance_error || std::isnan(e.resonance_error))) continue;
    e.resonance_error = number;
    e.resonant_mode = int(m) + 1;
    e.amplification = amplification;
    e.resonant_step =
        2 * half / omega_[m] * std::sqrt(0.2 * coarse_limit / std::max(2 * error * amplification, 1e-300));
  }
}

// Turns alone would take noise for a vibration, the rms of the change alone a jump.
void Resolution::find_load(StepEvidence& e) const {
  double change = 0, square = 0, largest = 0;
  std::size_t first = 0;
  for (std::size_t m = 0; m < omega_.size(); ++m) {
    if (omega_[m] == 0) continue;
    const double about_mean = load_square_[m] - load_[m] * load_[m] / sums_[time];
    change += change_[m];
    square += about_mean;
    if (about_mean > largest) largest = about_mean, first = m;
  }
  if (!(square > 0) || turns_[first] < least_turns) return;
  e.load_omega = std::min(std::sqrt(change / square), std::numbers::pi * turns_[first] / sums_[time]);
  e.load_over_last = e.load_omega / omega_.back();
}

void Resolution::load(const PressureLoad::Seen& seen) {
  sums_[load_apart] += seen.apart;
  sums_[load_size] += seen.size;
  sums_[load_samples] += 1;
}

void Resolution::impact(double stiffness, double work, double energy, double dt) {
  if (!(stiffness > 0) || std::abs(work) <= least_work * energy) return;
  const double duration = std::numbers::pi / std::sqrt(stiffness);
  if (dt / duration <= sums_[impact_share]) return;
  sums_[impact_share] = dt / duration;
  sums_[impact_time] = duration;
}

/// Integral of its square over mass and time: modes are orthonormal there. Rigid motions count for their rounding.
double Resolution::displacement() const {
  double sum = 1e-12 * sums_[rigid];
  for (const double one : moved_) sum += one;
  return sum;
}

StepEvidence Resolution::evidence(bool at_end) const {
  StepEvidence e;
  if (sums_[impact_share] > 0) e.contact_share = sums_[impact_share], e.contact_time = sums_[impact_time];
  if (sums_[load_size] > 0 && (at_end || sums_[load_samples] >= least_samples))
    e.load_apart = std::sqrt(sums_[load_apart] / sums_[load_size]);
  const double all = displacement();
  if (!(all > 0) || (!at_end && sums_[time] < 0.25 * longest_period_)) return e;
  double coarse = 0, above = 0;
  std::size_t worst = 0;
  for (std::size_t m = 0; m < omega_.size(); ++m) {
    coarse += coarse_[m];
    if (coarse_[m] > coarse_[worst]) worst = m;
    if (moved_[m] >= 1e-4 * all) e.last_mode_omega = omega_[m];
  }
  find_resonance(e, all);
  find_load(e);
  e.coarse_share = std::sqrt(coarse / all);
  if (coarse == 0) return e;
  e.coarse_mode = int(worst) + 1;
  e.steps_a_period = 2 * std::numbers::pi / (omega_[worst] * longest_step_[worst]);
  for (std::size_t m = omega_.size(); m-- > 0;) {
    above += swung_[m];
    e.recommended_step = 2 * std::numbers::pi / (omega_[m] * good_steps);
    if (above > coarse_limit * coarse_limit * all) break;
    if (m > 0 && omega_[m - 1] == 0) break;
  }
  return e;
}

/// All that is remembered, in the order in which it is saved.
template <class R>
auto Resolution::parts(R& r) {
  return std::array{&r.sums_,        &r.moved_,     &r.swung_,  &r.coarse_,     &r.longest_step_,   &r.rate_,
                    &r.drive_,       &r.rate_step_, &r.driven_, &r.last_load_,  &r.largest_change_, &r.load_,
                    &r.load_square_, &r.change_,    &r.turns_,  &r.last_change_};
}

std::vector<double> Resolution::state() const {
  std::vector<double> all;
  for (const auto* part : parts(*this)) all.insert(all.end(), part->begin(), part->end());
  return all;
}

void Resolution::restore(const std::vector<double>& state) {
  auto at = state.begin();
  for (auto* part : parts(*this)) {
    std::copy(at, at + std::ssize(*part), part->begin());
    at += std::ssize(*part);
  }
}

}  // namespace couplet::plate
