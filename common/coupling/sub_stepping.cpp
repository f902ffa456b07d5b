// SPDX-License-Identifier: Apache-2.0
#include "common/coupling/sub_stepping.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <tuple>

namespace couplet::coupling {

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

/// At t^n + share dt; a mean over the step stands for all of it.
Exchange SubStepping::input_at(double share) const {
  Exchange in = given_;
  if (!step_.waveform) return in;
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
  before_ = std::move(given_);
  has_start_ = moved_on_ = false;
  return report;
}

void SubStepping::save(io::CheckpointWriter& file) const {
  if (moved_on_) {  // a step that was given up: what is saved is state n
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
