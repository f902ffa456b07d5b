// SPDX-License-Identifier: Apache-2.0
#include "coupler/output/monitor.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

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

namespace {

/// CPU seconds of this process without waiting for replies.
double own_seconds(const std::vector<Partner>& partners) {
  double seconds = coupling::processor_seconds();
  for (const Partner& p : partners) seconds -= p.channel->waiting_seconds();
  return seconds;
}

}  // namespace

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
      "{} steps, {} halvings in {:.2f} s; coupling iterations: mean {:.2f}, max {}\n"
      "  {:<20} {:>11} {:>11} {:>15}",
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
  std::vector<Worker> workers;
  for (std::size_t i = 0; i < partners.size(); ++i)
    workers.push_back({partners[i].name(), partners[i].channel->ranks(), worked_[i]});
  // The first pass of the moved participant includes that of the mesh mover, which is listed first.
  for (Worker& worker : workers)
    if (schedule.mover && worker.name == *schedule.moved)
      worker.seconds = std::max(0., worker.seconds - workers.front().seconds);
  return waiting_sentence(workers, schedule.side_by_side);
}

namespace {

// Minimum gain for proposing a division.
constexpr double worth_it = 0.1;
// Runs below this time are too short to judge [s].
constexpr double too_short = 1;

double work(const Worker& w) { return w.seconds * w.ranks; }

double time(const std::vector<Worker>& workers, const std::vector<int>& ranks, bool side_by_side) {
  double sum = 0, longest = 0;
  for (std::size_t i = 0; i < workers.size(); ++i) {
    const double t = work(workers[i]) / ranks[i];
    sum += t;
    longest = std::max(longest, t);
  }
  return side_by_side ? longest : sum;
}

std::string listed(const std::vector<Worker>& workers, const std::vector<int>& ranks) {
  std::string text;
  for (std::size_t i = 0; i < workers.size(); ++i)
    text += fmt::format("{}{}={}", text.empty() ? "" : ",", workers[i].name, ranks[i]);
  return text;
}

}  // namespace

std::vector<int> divide_ranks(const std::vector<Worker>& workers, int total, bool side_by_side) {
  std::vector<int> ranks(workers.size(), 1);
  // Adds each rank where it helps most; optimal for convex sums and for the maximum of decreasing functions.
  for (int n = int(workers.size()); n < total; ++n) {
    std::size_t best = 0;
    double most = -1;
    for (std::size_t i = 0; i < workers.size(); ++i) {
      const double gain = work(workers[i]) / (side_by_side ? ranks[i] : ranks[i] * (ranks[i] + 1.));
      if (gain > most) most = gain, best = i;
    }
    ++ranks[best];
  }
  return ranks;
}

std::string waiting_sentence(const std::vector<Worker>& workers, bool side_by_side) {
  double sum = 0;
  int total = 0;
  std::vector<int> now;
  for (const Worker& w : workers) {
    sum += w.seconds;
    total += w.ranks;
    now.push_back(w.ranks);
  }
  if (workers.size() < 2 || sum < too_short) return {};
  const auto slowest = std::ranges::max_element(workers, {}, &Worker::seconds);
  std::string text =
      side_by_side
          ? fmt::format("waiting: side by side, all wait for '{}', which takes longest", slowest->name)
          : fmt::format("waiting: one after another, the others wait for '{}' {:.0f} % of the time at work",
                        slowest->name, 100 * slowest->seconds / sum);
  if (total == int(workers.size()))
    return text + fmt::format("; a further rank is best given to it ('-n {}={}')", slowest->name, 2);
  const std::vector<int> better = divide_ranks(workers, total, side_by_side);
  const double before = time(workers, now, side_by_side), after = time(workers, better, side_by_side);
  if (after > (1 - worth_it) * before)
    return text + fmt::format("; the ranks fit ({})", listed(workers, now));
  return text +
         fmt::format("; '-n {}' in place of {} would take {:.0f} % less if the work divides by the ranks",
                     listed(workers, better), listed(workers, now), 100 * (1 - after / before));
}

}  // namespace couplet::coupler
