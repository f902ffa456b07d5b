// SPDX-License-Identifier: Apache-2.0
#include "coupler/guards.hpp"

#include <algorithm>
#include <cmath>

#include "common/base/error.hpp"

namespace couplet {
namespace {

double norm(const std::vector<double>& values) {
  double square = 0;
  for (const double v : values) square += v * v;
  return std::sqrt(square);
}

double dot(const std::vector<double>& a, const std::vector<double>& b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += a[i] * b[i];
  return sum;
}

const char* cure_of_oscillation(Scheme scheme) {
  switch (scheme) {
    case Scheme::explicit_:
      return "This is the explicit coupling's added-mass instability: the fluid that moves along is too "
             "heavy "
             "for the "
             "structure, and no smaller step helps. `scheme: semi-implicit` takes the added mass into the "
             "iteration, "
             "`scheme: implicit` all of the fluid.";
    case Scheme::semi_implicit:
      return "The semi-implicit scheme takes the wall shear at the guessed velocity: where viscosity is "
             "strong "
             "and the "
             "structure light, that grows though every step converges, and no smaller step helps much. "
             "`scheme: implicit` iterates it.";
    default:
      return "The scheme iterates all that the participants exchange: tighten `convergence.relative`, lower "
             "`predictor.order`, or look at the participants' own time schemes.";
  }
}

}  // namespace

void IterationGuard::pass(double residual, double omega, bool constant) {
  ++passes_;
  if (passes_ == 1) first_ = residual;
  if (passes_ > 1 && residual > last_) {
    if (growing_ == 0) at_turn_ = last_;
    ++growing_;
  } else {
    growing_ = 0;
  }
  last_ = residual;
  if (growing_ == 0 || !(residual > 2 * at_turn_)) return;
  const bool ran_away = residual > too_far * first_;
  if (growing_ < patience && !ran_away) return;
  const double factor = std::pow(residual / at_turn_, 1. / growing_);
  if (!constant)
    throw SolveFailure(
        "the coupling diverges: the residual has grown by {:.3g} a pass over {} passes. The last factor was "
        "{:.3g}. If smaller steps do not help, `acceleration.type: iqn-ils` follows several modes at once, "
        "and "
        "the "
        "participants' own tolerances may be too loose for it.",
        factor, growing_, omega);
  // |1 - omega (1 + r)| = factor for the heaviest mode
  const double r = (factor + 1) / omega - 1;
  throw SchemeFailure(
      "the coupling diverges: the residual has grown by {:.3g} a pass over {} passes. With constant "
      "relaxation "
      "{:g} "
      "that is an added mass of about {:.3g} times the structure's; only relaxations below {:.3g} converge, "
      "whatever "
      "the step. `acceleration.type: aitken` or `iqn-ils` adapt it.",
      factor, growing_, omega, r, 2 / (1 + r));
}

std::optional<std::string> OscillationGuard::accepted(const std::vector<double>& x, double dt,
                                                      Scheme scheme) {
  const bool other_step = std::abs(dt - dt_) > 1e-9 * dt;
  std::vector<double> difference;
  if (!other_step && !old_x_.empty()) {
    difference.resize(x.size());
    for (std::size_t i = 0; i < x.size(); ++i) difference[i] = x[i] - 2 * x_[i] + old_x_[i];
  }
  if (other_step) motion_.clear();
  if (!x_.empty() && !other_step) {
    double square = 0;
    for (std::size_t i = 0; i < x.size(); ++i) square += (x[i] - x_[i]) * (x[i] - x_[i]);
    motion_.push_back(std::sqrt(square));
    if (motion_.size() > 4) motion_.pop_front();
  }
  const double size = norm(difference);
  const double old_size = norm(difference_);
  // It turns round: most of the shape is the last one's with the other sign.
  const bool turned = !difference.empty() && !difference_.empty() && size > 0 && old_size > 0 &&
                      dot(difference, difference_) < -0.3 * size * old_size;
  if (turned) {
    if (turns_ == 0) sizes_.assign(1, old_size);
    ++turns_;
    sizes_.push_back(size);
  } else {
    turns_ = 0;
    sizes_.clear();
  }
  growth_ = 0;
  old_x_ = other_step ? std::vector<double>{} : std::move(x_);
  x_ = x;
  dt_ = dt;
  difference_ = std::move(difference);
  if (turns_ < 4) return {};
  // Pairs of neighbours: the growth need not be even.
  const std::size_t n = sizes_.size();
  const double then = sizes_[0] + sizes_[1], now = sizes_[n - 2] + sizes_[n - 1];
  growth_ = std::pow(now / then, 1. / double(n - 2));
  double moved = 0;
  for (const double m : motion_) moved = std::max(moved, m);
  const double wanted = turns_ < 8 ? 3 : turns_ < 20 ? 2 : 1.5;
  if (!(now > wanted * then) || now < moved) return {};
  return fmt::format(
      "the interface swings to and fro from step to step and more each time: over {} steps the swing has "
      "grown "
      "{:.3g}-fold, {:.3g} a step, though every step was solved. {}",
      turns_, now / then, growth_, cure_of_oscillation(scheme));
}

std::optional<std::string> WorkGuard::accepted(double fluid, double structure, Scheme scheme) {
  fluid_ += fluid;
  structure_ += structure;
  exchanged_ += std::max(std::abs(fluid), std::abs(structure));
  ++steps_;
  last_.push_back({fluid, structure});
  if (last_.size() > window) last_.pop_front();
  if (last_.size() < window || steps_ < 2 * window) return {};
  double given = 0, taken = 0, size = 0;
  for (const auto& [f, s] : last_) given += f, taken += s, size += std::max(std::abs(f), std::abs(s));
  const double apart = std::abs(given - taken);
  // More than half of what goes to and fro is made by the scheme, and it is no small part of the whole run's.
  if (!(apart > 0.5 * size) || !(apart > 0.1 * exchanged_)) return {};
  return fmt::format(
      "the work on the two sides of the interface has parted: over the last {} steps the fluid gave {:.4g} J "
      "and "
      "the "
      "structure took {:.4g} J. The scheme itself feeds or drains the motion. {}",
      window, given, taken, cure_of_oscillation(scheme));
}

WorkGuard::Verdict WorkGuard::verdict() const {
  if (steps_ == 0 || exchanged_ == 0) return {true, ""};
  const double apart = std::abs(fluid_ - structure_), part = apart / exchanged_;
  Verdict v;
  v.sound = part < 0.05;
  v.text = fmt::format(
      "interface work of {} steps: fluid gave {:.6g} J, structure took {:.6g} J, {:.2g} % of what went to "
      "and fro "
      "apart: {}",
      steps_, fluid_, structure_, 100 * part,
      v.sound ? "sound."
              : "NOT SOUND, the coupling made or lost this work; take smaller steps or a tighter scheme.");
  return v;
}

void WorkGuard::restore(const std::array<double, 4>& totals) {
  fluid_ = totals[0];
  structure_ = totals[1];
  exchanged_ = totals[2];
  steps_ = long(totals[3]);
  last_.clear();
}

}  // namespace couplet
