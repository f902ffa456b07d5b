// SPDX-License-Identifier: Apache-2.0
#include "coupler/monitor.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "common/log/log.hpp"
#include "common/log/progress.hpp"

namespace couplet {
namespace {

std::vector<std::string> balance_columns(int dim) {
  std::vector<std::string> columns{"time [s]"};
  for (const char* side : {"fluid", "structure"}) {
    for (int c = 0; c < dim; ++c) columns.push_back(fmt::format("{} force {} [N]", side, "xyz"[c]));
    columns.push_back(fmt::format("{} work of the step [J]", side));
  }
  return columns;
}

}  // namespace

Monitor::Monitor(const std::filesystem::path& folder, int dim, double end_time, double restart_time)
    : residuals_(folder / "residuals.csv",
                 {"time [s]", "dt [s]", "step", "iteration", "relative residual", "absolute residual [m]",
                  "relaxation"},
                 restart_time),
      balance_(folder / "balance.csv", balance_columns(dim), restart_time),
      dim_(dim),
      end_time_(end_time),
      start_time_(std::isnan(restart_time) ? 0. : restart_time) {}

void Monitor::iteration(const Step& step, int number, const Residual& residual, double omega) {
  residuals_.row(std::array<double, 7>{step.time + step.dt, step.dt, double(step.number + 1), double(number),
                                       residual.relative, residual.absolute, omega});
}

void Monitor::balance(double time, const Balance& fluid, const Balance& structure) {
  std::vector<double> row{time};
  for (const Balance* side : {&fluid, &structure}) {
    for (int c = 0; c < dim_; ++c) row.push_back(side->force[c]);
    row.push_back(side->work);
  }
  balance_.row(row);
}

void Monitor::step(const Step& step, double time, const FixedPointResult& result,
                   const std::vector<std::pair<std::string, double>>& seconds) {
  const auto now = Clock::now();
  const double wall = std::chrono::duration<double>(now - step_start_).count();
  step_start_ = now;
  ++steps_;
  iterations_ += result.iterations;
  most_iterations_ = std::max<long>(most_iterations_, result.iterations);
  if (total_.empty()) total_.resize(seconds.size());
  std::string text;
  for (std::size_t i = 0; i < seconds.size(); ++i) {
    text += fmt::format("  {} {:.2f} s", seconds[i].first, seconds[i].second);
    total_[i].first = seconds[i].first;
    total_[i].second += seconds[i].second;
  }
  const double waited = std::max(0., wall - seconds[0].second - seconds[1].second);
  waited_ += waited;
  log::info("t={:.6g}/{:g} s  step {}{}  {} its  |r|={:.1e}{}  wait {:.2f} s  {}", time, end_time_,
            step.number + 1, step.scheme == Scheme::explicit_ ? " (explicit)" : "", result.iterations,
            result.residual.relative, text, waited,
            log::eta(time - start_time_, end_time_ - start_time_,
                     std::chrono::duration<double>(now - start_).count()));
}

std::string Monitor::summary(int halvings) const {
  std::string text =
      fmt::format("{} steps, {} halvings; coupling iterations: {:.2f} on average, {} at most", steps_,
                  halvings, steps_ > 0 ? double(iterations_) / double(steps_) : 0., most_iterations_);
  for (const auto& [name, seconds] : total_)
    text += fmt::format("\n  {:<20} {:>9.2f} s {:>9.3f} ms a step", name, seconds,
                        1e3 * seconds / double(steps_));
  if (steps_ > 0)
    text += fmt::format("\n  {:<20} {:>9.2f} s {:>9.3f} ms a step", "coupler and waiting", waited_,
                        1e3 * waited_ / double(steps_));
  return text;
}

}  // namespace couplet
