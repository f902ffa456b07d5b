// SPDX-License-Identifier: Apache-2.0
#include "common/coupling/step_plan.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <charconv>
#include <cmath>
#include <limits>
#include <tuple>

#include "common/base/error.hpp"

namespace couplet::coupling {

namespace {

constexpr int least_patience = 2, most_patience = 64;

// Relative length up to which a remainder of the time belongs to the last step. It results from rounded step
// sizes such as 0.0333333333 s. As a separate step it would be too short for accurate forces.
constexpr double rest_taken_along = 1e-6;

/// Number of nominal steps to the end, without a step for round-off of the quotient.
GlobalIndex count(double end_time, double nominal_dt) {
  const double steps = end_time / nominal_dt;
  if (!(steps <= StepPlan::most_steps))
    throw Error("{:g} s take {:g} steps of {:g} s; at most {:g} are allowed. Is a unit missing?", end_time,
                steps, nominal_dt, StepPlan::most_steps);
  return static_cast<GlobalIndex>(std::ceil(steps * (1 - 1e-15) - rest_taken_along));
}

}  // namespace

StepPlan::StepPlan(double end_time, double nominal_dt, int max_halvings)
    : end_time_(end_time),
      nominal_dt_(nominal_dt),
      max_halvings_(max_halvings),
      n_nominal_(count(end_time, nominal_dt)),
      largest_dt_(std::numeric_limits<double>::infinity()) {
  assert(nominal_dt > 0 && max_halvings >= 0 && max_halvings <= 30);
}

double StepPlan::nominal_time(GlobalIndex i) const {
  const double t = double(i) * nominal_dt_;
  return i == n_nominal_ && std::abs(t - end_time_) > 1e-9 * nominal_dt_ ? end_time_ : t;
}

double StepPlan::nominal_length() const {
  if (nominal_ + 1 < n_nominal_) return nominal_dt_;
  const double rest = end_time_ - double(nominal_) * nominal_dt_;
  // A step that differs from a nominal one or its halves only by round-off is set to it, so matrices can be
  // reused bit for bit, even after a restart.
  for (int level = 0; level <= max_halvings_; ++level)
    if (const double dt = std::ldexp(nominal_dt_, -level); std::abs(rest - dt) <= 1e-9 * dt) return dt;
  return rest;
}

double StepPlan::time() const {
  return nominal_time(nominal_) +
         (tick_ == 0 ? 0. : std::ldexp(nominal_length() * double(tick_), -max_halvings_));
}

int StepPlan::level() const {
  int level = wanted_level_;
  while (level < max_halvings_ && std::ldexp(nominal_length(), -level) > largest_dt_ * (1 + 1e-12)) ++level;
  // A longer step may only start at a node of its own grid.
  while (level < max_halvings_ && tick_ % (1L << (max_halvings_ - level)) != 0) ++level;
  return level;
}

double StepPlan::dt() const { return std::ldexp(nominal_length(), -level()); }

bool StepPlan::is_last() const {
  return nominal_ + 1 == n_nominal_ && tick_ + (1L << (max_halvings_ - level())) == 1L << max_halvings_;
}

void StepPlan::accepted() {
  const int used = level();
  tick_ += 1L << (max_halvings_ - used);
  ++accepted_;
  if (tick_ == 1L << max_halvings_) {
    tick_ = 0;
    ++nominal_;
  }
  if (++calm_ < patience_) return;
  calm_ = 0;
  if (wanted_level_ > 0)
    --wanted_level_;
  else
    patience_ = least_patience;
}

bool StepPlan::halve() {
  const int used = level();
  if (used >= max_halvings_) return false;
  wanted_level_ = used + 1;
  calm_ = 0;
  patience_ = std::min(2 * patience_, most_patience);
  return true;
}

std::array<double, 6> StepPlan::state() const {
  return {double(nominal_), double(tick_),     double(wanted_level_),
          double(calm_),    double(accepted_), double(patience_)};
}

void StepPlan::restore(const std::array<double, 6>& state, double time) {
  nominal_ = GlobalIndex(state[0]);
  tick_ = long(state[1]);
  wanted_level_ = std::min(int(state[2]), max_halvings_);
  calm_ = int(state[3]);
  accepted_ = GlobalIndex(state[4]);
  patience_ = int(state[5]);
  if (std::abs(this->time() - time) <= 1e-9 * nominal_dt_) return;
  nominal_ = std::llround(time / nominal_dt_);
  tick_ = 0;
  if (std::abs(this->time() - time) > 1e-9 * nominal_dt_)
    throw Error(
        "The checkpoint is at t = {:g} s, which is not a multiple of the time step {:g} s: restart with the "
        "time step of the run that wrote it, or with a step that divides this time.",
        time, nominal_dt_);
}

Interface SubStepping::initialise() {
  Interface interface = inner_.initialise();
  takes_ = interface.takes;
  gives_ = interface.gives;
  for (const auto& [place, ids, n] :
       {std::tuple(Interface::Place::vertices, interface.vertex_ids, interface.vertices.size()),
        std::tuple(Interface::Place::faces, interface.face_ids, interface.face_centres.size())})
    places_[place] = {ids, n};
  return interface;
}

bool SubStepping::is_mean(const std::string& name) const {
  for (const auto* list : {&takes_, &gives_})
    for (const auto& datum : *list)
      if (datum.name == name) return is_amount(datum);
  return false;
}

void SubStepping::begin_step(const Step& step) {
  step_ = step;
  if (steps_ == 1) inner_.begin_step(step);
}

void SubStepping::back_to_start() {
  if (!has_start_) {
    start_.clear();
    io::CheckpointWriter writer(start_);
    inner_.save(writer);
    writer.close();
    has_start_ = true;
  } else if (moved_on_) {
    io::CheckpointReader reader(start_);
    inner_.load(reader);
  }
  moved_on_ = false;
}

/// Input at t^n + share dt. A mean over the step is constant.
Exchange SubStepping::input_at(double share) const {
  Exchange in = given_;
  for (auto& [name, values] : in) {
    const auto before = before_.find(name);
    if (before == before_.end() || before->second.size() != values.size() || is_mean(name)) continue;
    for (std::size_t i = 0; i < values.size(); ++i)
      values[i] = before->second[i] + share * (values[i] - before->second[i]);
  }
  return in;
}

Exchange SubStepping::solve(const Exchange& in) {
  if (steps_ == 1) return inner_.solve(in);
  given_ = in;
  back_to_start();
  const double dt = step_.dt / steps_;
  iterations_ = 0;
  Exchange mean, last;
  for (int k = 1; k <= steps_; ++k) {
    Step part = step_;
    part.time = step_.time + (k - 1) * dt;
    part.dt = dt;
    part.number = step_.number * steps_ + k - 1;
    if (k > 1) {
      moved_on_ = true;
      iterations_ += inner_.accept_step().iterations;
    }
    inner_.begin_step(part);
    last = inner_.solve(input_at(double(k) / steps_));
    for (const auto& [name, values] : last) {
      std::vector<double>& sum = mean[name];
      sum.resize(values.size(), 0.);
      for (std::size_t i = 0; i < values.size(); ++i) sum[i] += values[i] / steps_;
    }
  }
  for (auto& [name, values] : last)
    if (is_mean(name)) values = mean.at(name);
  return last;
}

StepReport SubStepping::accept_step() {
  StepReport report = inner_.accept_step();
  if (steps_ == 1) return report;
  report.dt = step_.dt;
  report.iterations += iterations_;
  report.change *= steps_;
  before_ = std::move(given_);
  has_start_ = moved_on_ = false;
  return report;
}

void SubStepping::save(io::CheckpointWriter& file) const {
  if (moved_on_) {  // the step was given up, so state n is saved
    io::CheckpointReader reader(start_);
    inner_.load(reader);
    moved_on_ = false;
  }
  inner_.save(file);
  if (steps_ == 1) return;
  for (const auto& datum : takes_) {
    const auto found = before_.find(datum.name);
    const auto& [ids, n] = places_.at(datum.place);
    file.write(parallel::GlobalOrder::by_numbers(file.comm(), ids, n), "before." + datum.name,
               found == before_.end() ? std::vector<double>{} : found->second);
  }
}

void SubStepping::load(io::CheckpointReader& file) {
  inner_.load(file);
  has_start_ = moved_on_ = false;
  if (steps_ == 1) return;
  before_.clear();
  for (const auto& datum : takes_) {
    const auto& [ids, n] = places_.at(datum.place);
    const auto order = parallel::GlobalOrder::by_numbers(file.comm(), ids, n);
    if (auto values = file.read(order, "before." + datum.name); !values.empty())
      before_[datum.name] = std::move(values);
  }
}

std::string WithinStep::name(const std::string& datum, double share) {
  return fmt::format("{}{}{:.15g}", datum, mark, share);
}

std::optional<std::pair<std::string, double>> WithinStep::parse(std::string_view name) {
  const std::size_t at = name.rfind(mark);
  if (at == std::string_view::npos || at == 0) return {};
  const char* last = name.data() + name.size();
  double share = 0;
  const auto [end, code] = std::from_chars(name.data() + at + 1, last, share);
  if (code != std::errc() || end != last || !(share > 0 && share < 1)) return {};
  return std::pair(std::string(name.substr(0, at)), share);
}

}  // namespace couplet::coupling
