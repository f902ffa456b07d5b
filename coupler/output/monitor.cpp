// SPDX-License-Identifier: Apache-2.0
#include "coupler/output/record.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "common/coupling/wait.hpp"
#include "common/log/log.hpp"
#include "common/log/progress.hpp"
#include "common/parallel/collective.hpp"

namespace couplet::coupler {
namespace {

std::vector<std::string> participant_columns(const std::vector<std::string>& names) {
  std::vector<std::string> columns{"time [s]", "step", "coupling iterations", "wall clock [s]"};
  for (const std::string& name : names)
    for (const char* what : {"working [s]", "waiting [s]", "linear iterations", "time error", "energy [J]"})
      columns.push_back(name + " " + what);
  columns.push_back("coupler working [s]");
  return columns;
}

/// CPU seconds of this process without waiting for replies.
double own_seconds(const std::vector<Partner>& partners) {
  double seconds = coupling::processor_seconds();
  for (const Partner& p : partners) seconds -= p.channel->waiting_seconds();
  return seconds;
}

}  // namespace

Monitor::Monitor(MPI_Comm comm, std::filesystem::path folder, std::vector<std::string> names, double end_time,
                 double restart_time)
    : folder_(std::move(folder)),
      writes_(parallel::comm_rank(comm) == 0),
      names_(std::move(names)),
      end_time_(end_time),
      restart_time_(restart_time),
      start_time_(std::isnan(restart_time) ? 0. : restart_time),
      worked_(names_.size(), 0.) {
  if (!writes_) return;
  // Removes optional files of an earlier run, which could be mistaken for this one's.
  if (std::isnan(restart_time))
    for (const char* file : {"balance.csv", "amounts.csv", "volume.csv", "watch.csv"})
      std::filesystem::remove(folder_ / file);
  residuals_.emplace(folder_ / "residuals.csv",
                     std::vector<std::string>{"time [s]", "dt [s]", "step", "iteration", "relative residual",
                                              "absolute residual [m]", "relaxation"},
                     restart_time);
  participants_.emplace(folder_ / "participants.csv", participant_columns(names_), restart_time);
}

void Monitor::iteration(const coupling::Step& step, int number, const Residual& residual, double omega) {
  if (!writes_) return;
  residuals_->row(std::array<double, 7>{step.time + step.dt, step.dt, double(step.number + 1), double(number),
                                        residual.relative, residual.absolute, omega});
}

void Monitor::row(const char* file, double time, const std::vector<std::string>& columns,
                  const std::vector<double>& values) {
  if (!writes_ || columns.empty()) return;
  auto table = tables_.find(file);
  if (table == tables_.end()) {
    std::vector<std::string> all{"time [s]"};
    all.insert(all.end(), columns.begin(), columns.end());
    table = tables_.try_emplace(file, folder_ / file, all, restart_time_).first;
  }
  std::vector<double> row{time};
  row.insert(row.end(), values.begin(), values.end());
  table->second.row(row);
}

void Monitor::start(const std::vector<Partner>& partners) {
  step_start_ = Clock::now();
  own_before_ = own_seconds(partners);
}

void Monitor::step(const coupling::Step& step, double time, const FixedPointResult& result,
                   const std::vector<Partner>& partners) {
  const auto now = Clock::now();
  const double wall = std::chrono::duration<double>(now - step_start_).count();
  step_start_ = now;
  wall_ += wall;
  ++steps_;
  iterations_ += result.iterations;
  most_iterations_ = std::max<long>(most_iterations_, result.iterations);
  std::vector<double> row{time, double(step.number + 1), double(result.iterations), wall};
  std::string text;
  double longest = 0;
  for (std::size_t i = 0; i < partners.size(); ++i) {
    const double worked = partners[i].report.seconds;
    worked_[i] += worked;
    longest = std::max(longest, worked);
    text += fmt::format("  {} {:.2f} s", partners[i].name(), worked);
    row.insert(row.end(), {worked, std::max(0., wall - worked), double(partners[i].report.iterations),
                           partners[i].report.error, partners[i].report.energy});
  }
  const double own = own_seconds(partners);
  row.push_back(own - own_before_);
  own_ += own - std::exchange(own_before_, own);
  if (!writes_) return;
  participants_->row(row);
  if (step.scheme == coupling::Scheme::explicit_ &&
      std::chrono::duration<double>(now - last_line_).count() < 0.5 && time < end_time_)
    return;
  last_line_ = now;
  log::info("t={:.6g}/{:g} s  step {}{}  {} its  |r|={:.1e}{}  {}", time, end_time_, step.number + 1,
            step.scheme == coupling::Scheme::explicit_ ? " (explicit)" : "", result.iterations,
            result.residual.relative, text,
            log::eta(time - start_time_, end_time_ - start_time_,
                     std::chrono::duration<double>(now - start_).count()));
}

std::string Monitor::summary(int halvings) const {
  const double steps = double(std::max(1L, steps_));
  std::string text = fmt::format(
      "{} steps, {} halvings in {:.2f} s; coupling iterations: mean {:.2f}, max {}\n  {:<20} {:>11} {:>11} {:>15}",
      steps_, halvings, wall_, double(iterations_) / steps, most_iterations_, "", "working", "waiting",
      "working");
  for (std::size_t i = 0; i < names_.size(); ++i)
    text += fmt::format("\n  {:<20} {:>9.2f} s {:>9.2f} s {:>9.3f} ms per step", names_[i], worked_[i],
                        std::max(0., wall_ - worked_[i]), 1e3 * worked_[i] / steps);
  text += fmt::format("\n  {:<20} {:>9.2f} s {:>11} {:>9.3f} ms per step (processor time)", "coupler", own_,
                      "", 1e3 * own_ / steps);
  return text;
}

std::string Monitor::waiting(const std::vector<Partner>& partners, const Schedule& schedule) const {
  std::vector<double> seconds = worked_;
  // The first pass of the moved participant includes that of the mesh mover, which is listed first.
  for (std::size_t i = 0; i < seconds.size(); ++i)
    if (schedule.mover && partners[i].name() == *schedule.moved)
      seconds[i] = std::max(0., seconds[i] - seconds.front());
  return waiting_sentence(names_, seconds, schedule.side_by_side);
}

std::string waiting_sentence(const std::vector<std::string>& names, const std::vector<double>& seconds,
                             bool side_by_side) {
  constexpr double too_short = 1;  // [s]
  const double sum = std::accumulate(seconds.begin(), seconds.end(), 0.);
  if (seconds.size() < 2 || sum < too_short) return {};
  const auto slowest = std::ranges::max_element(seconds);
  const std::string& name = names[std::size_t(slowest - seconds.begin())];
  if (side_by_side)
    return fmt::format(
        "waiting: the participants run concurrently, and all wait for '{}', which takes longest", name);
  return fmt::format(
      "waiting: the participants run one after another, and the others wait for '{}' during {:.0f} % of the computing time",
      name, 100 * *slowest / sum);
}

}  // namespace couplet::coupler
