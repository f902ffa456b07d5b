// SPDX-License-Identifier: Apache-2.0
#include "coupler/diagnostics/guards.hpp"

#include <algorithm>
#include <cmath>

#include "common/base/error.hpp"
#include "common/io/checkpoint.hpp"
#include "common/parallel/collective.hpp"

namespace couplet::coupler {
namespace {

double dot_over(MPI_Comm comm, const std::vector<double>& a, const std::vector<double>& b) {
  double total = 0;
  for (std::size_t i = 0; i < std::min(a.size(), b.size()); ++i) total += a[i] * b[i];
  return parallel::sum(comm, total);
}

double norm(MPI_Comm comm, const std::vector<double>& values) {
  return std::sqrt(dot_over(comm, values, values));
}

/// Cure of a motion that the scheme itself makes, where tests show one (tests/stability/coupling); else empty.
const char* cure_of(coupling::Scheme scheme) {
  return scheme == coupling::Scheme::explicit_
             ? " This is the added-mass instability of explicit coupling: the structure is too light for the fluid "
               "moving with it, and smaller steps do not help. `scheme: semi-implicit` iterates the added mass, "
               "`scheme: implicit` the whole fluid."
             : "";
}

// |1 - omega (1 + r)| = factor for the heaviest mode
std::string too_much_added_mass(double factor, int passes, double omega) {
  const double r = (factor + 1) / omega - 1;
  return fmt::format(
      "the coupling diverges: the residual grew by {:.3g} per pass over {}. With constant relaxation "
      "{:g} this implies an added mass of about {:.3g} times the structure's; only relaxations below {:.3g} "
      "converge, at any step. Use `acceleration.type: aitken` or `iqn-ils`, which adapt it.",
      factor, passes == 1 ? "a pass" : fmt::format("{} passes", passes), omega, r, 2 / (1 + r));
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
  if (!grows()) return;
  const bool ran_away = residual > too_far * first_;
  if (growing_ < patience && !ran_away) return;
  if (constant) throw SchemeFailure(too_much_added_mass(factor(), growing_, omega));
  throw SolveFailure(
      "the coupling diverges: the residual grew by {:.3g} per pass over {} passes, by {:.3g} in the last "
      "one. If smaller steps do not help, `acceleration.type: iqn-ils` handles several modes at once; the "
      "participants' own tolerances may be too loose for it.",
      factor(), growing_, omega);
}

bool IterationGuard::grows() const { return growing_ > 0 && last_ > 2 * at_turn_; }

double IterationGuard::factor() const { return std::pow(last_ / at_turn_, 1. / growing_); }

std::optional<std::string> IterationGuard::suspects(double relaxation) const {
  if (!grows()) return {};
  if (relaxation > 0) return too_much_added_mass(factor(), growing_, relaxation);
  return fmt::format(
      "the coupling diverges: the residual grew by {:.3g} per pass before a participant failed. Use a lower "
      "`acceleration.initial-relaxation`, or `predictor.order: 0` for the first steps.",
      factor());
}

std::string OscillationGuard::told(double growth, coupling::Scheme scheme) const {
  return fmt::format(
      "interface oscillation: with a period of two steps ({:.3g} s) the amplitude grew {:.3g}-fold in {} steps, to {:.2g} of "
      "the largest motion, although every step was solved: unstable.{}",
      2 * dt_, growth, turns_, share(), cure_of(scheme));
}

double OscillationGuard::pair(std::size_t i) const { return sizes_[i] + sizes_[i + 1]; }

// Each jump is four amplitudes over the step.
double OscillationGuard::share() const {
  return largest_ > 0 ? 0.125 * pair(sizes_.size() - 2) * dt_ / largest_ : 0;
}

bool OscillationGuard::counts() const {
  return share() > std::max(tolerance_, floor) && pair(sizes_.size() - 2) > 1.5 * before_;
}

std::optional<std::string> OscillationGuard::accepted(const std::vector<double>& x, double dt,
                                                      coupling::Scheme scheme) {
  std::vector<double> velocity(x.size()), jump;
  if (levels_ >= 1)
    for (std::size_t i = 0; i < x.size(); ++i) velocity[i] = (x[i] - x_[i]) / dt;
  if (levels_ >= 2) {
    jump = velocity;
    for (std::size_t i = 0; i < x.size(); ++i) jump[i] -= velocity_[i];
  }
  const double size = norm(comm_, jump), old_size = norm(comm_, jump_);
  speed_.push_back(norm(comm_, velocity));
  largest_ = std::max(largest_, norm(comm_, x));
  if (speed_.size() > 4) speed_.pop_front();
  // The motion reverses: most of its shape equals the last one with opposite sign.
  const bool turned = levels_ >= 3 && dot_over(comm_, jump, jump_) < -0.3 * size * old_size;
  if (turned) {
    if (turns_ == 0) sizes_.assign(1, old_size);
    ++turns_;
    sizes_.push_back(size);
  } else {
    for (std::size_t i = 0; i + 1 < sizes_.size(); ++i) before_ = std::max(before_, pair(i));
    turns_ = 0;
    sizes_.clear();
  }
  levels_ = std::min(levels_ + 1, 3);
  dt_ = dt;
  x_ = x;
  velocity_ = std::move(velocity);
  jump_ = std::move(jump);
  if (turns_ < 2 * periods || !counts()) return {};
  // Pairs of adjacent values, because the growth may be uneven.
  const std::size_t last = sizes_.size() - 2;
  const double then = pair(0), middle = pair(last / 2), now = pair(last);
  if (!(now > 3 * then) || now < *std::ranges::max_element(speed_)) return {};
  // Two frequencies that beat, and a load that rises, grow less and less. A rise like n^k has 1.33, 1.16, 1.10 here.
  if (middle * middle > 1.1 * then * now) return {};
  return told(now / then, scheme);
}

std::optional<std::string> OscillationGuard::suspects(coupling::Scheme scheme) const {
  if (turns_ < 2 || !counts()) return {};
  const double factor = sizes_.back() / sizes_.front();
  if (factor < 3 || 2 * sizes_.back() < *std::ranges::max_element(speed_)) return {};
  return told(factor, scheme);
}

void OscillationGuard::visit_numbers(io::Archive& archive) {
  archive.common("swings", turns_, levels_, sizes_, speed_, largest_, before_, dt_);
}

void OscillationGuard::visit_fields(io::Archive& archive, const parallel::GlobalOrder& order,
                                    const std::string& name, std::size_t first, std::size_t count,
                                    std::size_t width) {
  int k = 0;
  for (std::vector<double>* values : {&x_, &velocity_, &jump_}) {
    const bool known = levels_ > k++;
    std::vector<double> part;
    if (known && !archive.reads())
      part.assign(values->begin() + std::ptrdiff_t(first), values->begin() + std::ptrdiff_t(first + count));
    archive.field(order, name + "-" + std::to_string(k), part, width);
    if (!archive.reads()) continue;
    values->resize(first);
    values->insert(values->end(), part.begin(), part.end());
  }
}

void WorkGuard::accepted(double fluid, double structure) {
  fluid_ += fluid;
  structure_ += structure;
  exchanged_ += std::max(std::abs(fluid), std::abs(structure));
  stored_ = std::max(stored_, std::abs(structure_));
  ++steps_;
}

WorkGuard::Verdict WorkGuard::verdict(bool by_nearest, bool lagging) const {
  if (steps_ == 0 || exchanged_ == 0) return {};
  const double apart = std::abs(fluid_ - structure_), net = std::min(std::abs(fluid_), std::abs(structure_)),
               energy = energy_ > 0 ? energy_ : stored_, against = std::max(net, energy);
  Verdict v;
  // Only noise has been exchanged if the difference is at round-off.
  v.part = apart <= 1e-12 * exchanged_ ? 0 : apart / std::max(against, 1e-12 * exchanged_);
  v.sound = v.part < sound_part;
  v.useless = !lagging && apart / exchanged_ >= useless_part && steps_ >= judged_steps;
  v.text = fmt::format(
      "interface work of {} steps: fluid gave {:.6g} J, structure took {:.6g} J, {:.2g} % of the {} apart: {}",
      steps_, fluid_, structure_, 100 * v.part, net >= energy ? "net work" : "structure's largest energy",
      v.sound ? "closed."
      : lagging
          ? "NOT CLOSED: in explicit coupling load and motion belong to different times, and loads alternate from step to "
            "step; 'scheme: semi-implicit' closes it."
      : by_nearest
          ? "NOT CLOSED: `mapping.type: nearest` transfers motion and load by maps that are not transposes "
            "of each other; `projection` conserves the work on any meshes."
          : "NOT CLOSED: the wall seen by the fluid moved differently from the structure; use smaller steps "
            "or an iterating scheme.");
  return v;
}

}  // namespace couplet::coupler
