// SPDX-License-Identifier: Apache-2.0
#include "coupler/exchange_run.hpp"

#include <limits>

#include "common/base/error.hpp"
#include "common/io/checkpoint.hpp"
#include "common/log/log.hpp"
#include "common/log/progress.hpp"

namespace couplet {

ExchangeRun::ExchangeRun(const CouplingParameters& parameters, const SimulationParameters& simulation,
                         std::vector<std::unique_ptr<Channel>> channels, CouplerFolders folders)
    : parameters_(parameters),
      simulation_(simulation),
      folders_(std::move(folders)),
      loop_(MPI_COMM_SELF, simulation, Scheme::explicit_, folders_.checkpoints) {
  for (auto& channel : channels) partners_.push_back({std::move(channel)});
  given_.resize(partners_.size());
  trial_.resize(partners_.size());
  total_.assign(partners_.size(), 0);
}

std::vector<Partner*> ExchangeRun::everyone() {
  std::vector<Partner*> all;
  for (Partner& p : partners_) all.push_back(&p);
  return all;
}

void ExchangeRun::initialise() {
  enter_(Phase::initialise, {});
  std::vector<Interface> interfaces = initialise_all(everyone());
  std::vector<Side> sides;
  for (std::size_t i = 0; i < partners_.size(); ++i)
    sides.push_back({partners_[i].name(), std::move(interfaces[i])});
  links_.emplace(sides, parameters_.mapping);
  for (const std::string& note : links_->notes()) log::info("{}", note);
}

std::optional<std::string> ExchangeRun::attempt(const Step& step) {
  enter_(Phase::begin_step, step.time);
  for (Partner& p : partners_) p.seconds = 0;
  const auto ask = [&](std::size_t i, const std::vector<Exchange>& known) {
    partners_[i].send({Op::solve, {}, links_->input(i, known), 0, -1, ""});
  };
  try {
    ask_all(everyone(), {Op::begin_step, step, {}, 0, -1, ""});
    enter_(Phase::solve, step.time);
    if (parameters_.exchange->order == CouplingParameters::Exchange::Order::serial) {
      trial_ = given_;
      for (std::size_t i = 0; i < partners_.size(); ++i) {
        ask(i, trial_);
        trial_[i] = partners_[i].receive().data;
      }
      return {};
    }
    for (std::size_t i = 0; i < partners_.size(); ++i) ask(i, given_);
    std::string failures;
    for (std::size_t i = 0; i < partners_.size(); ++i) {
      try {
        trial_[i] = partners_[i].receive().data;
      } catch (const SolveFailure& failure) {
        failures += (failures.empty() ? "" : " ") + std::string(failure.what());
      }
    }
    if (!failures.empty()) return failures;
  } catch (const SolveFailure& failure) {
    return failure.what();
  }
  return {};
}

void ExchangeRun::accept(double time, int output) {
  enter_(Phase::accept, {});
  ask_all(everyone(), {Op::accept_step, {}, {}, time, output, ""});
  enter_(Phase::accept, time);
  given_ = trial_;
  write_amounts(time);
}

void ExchangeRun::write_amounts(double time) {
  const std::vector<Links::Amount> amounts = links_->amounts(given_);
  if (amounts.empty()) return;
  if (!amounts_) {
    std::vector<std::string> columns{"time [s]"};
    for (const auto& amount : amounts) columns.push_back(amount.column);
    amounts_.emplace(folders_.output / "amounts.csv", columns,
                     restarted_ ? start_time_ : std::numeric_limits<double>::quiet_NaN());
  }
  std::vector<double> row{time};
  for (const auto& amount : amounts) row.push_back(amount.value);
  amounts_->row(row);
}

void ExchangeRun::save(const std::filesystem::path& folder) {
  enter_(Phase::save, {});
  ask_all(everyone(), {Op::save, {}, {}, 0, -1, folder.string()});
  CheckpointWriter file(MPI_COMM_SELF, folder / "coupler.h5");
  for (std::size_t i = 0; i < partners_.size(); ++i)
    for (const auto& [name, values] : given_[i]) file.write(partners_[i].name() + "." + name, values);
  file.close();
}

void ExchangeRun::load() {
  enter_(Phase::load, {});
  const RunState state = read_run_state(folders_.restart);
  CheckpointReader file(MPI_COMM_SELF, folders_.restart / "coupler.h5");
  // At an accepted time after the first step everyone has given all it had announced.
  for (std::size_t i = 0; i < partners_.size(); ++i)
    for (const std::string& name : links_->given_by(i))
      given_[i][name] = file.read(partners_[i].name() + "." + name);
  loop_.restart(state);
  ask_all(everyone(), {Op::load, {}, {}, state.time, -1, folders_.restart.string()});
  start_time_ = state.time;
  restarted_ = true;
  log::info("continues from {} at t = {:g} s", folders_.restart.string(), state.time);
}

void ExchangeRun::report(const Step& step, double time) {
  for (std::size_t i = 0; i < partners_.size(); ++i) total_[i] += partners_[i].seconds;
  const auto now = Clock::now();
  if (std::chrono::duration<double>(now - last_line_).count() < 0.5 && time < simulation_.end_time) return;
  last_line_ = now;
  log::info("t={:g}/{:g} s  step {}  dt={:g} s  {}", time, simulation_.end_time, step.number + 1, step.dt,
            log::eta(time - start_time_, simulation_.end_time - start_time_,
                     std::chrono::duration<double>(now - start_).count()));
}

std::string ExchangeRun::summary() const {
  const double wall = std::chrono::duration<double>(Clock::now() - start_).count();
  std::string text = fmt::format("{} steps, {} halvings in {:.2f} s", loop_.steps(), loop_.halvings(), wall);
  for (std::size_t i = 0; i < partners_.size(); ++i)
    text += fmt::format("\n  {:<20} {:>9.2f} s {:>9.3f} ms a step", partners_[i].name(), total_[i],
                        1e3 * total_[i] / double(std::max<GlobalIndex>(1, loop_.steps())));
  return text;
}

std::string ExchangeRun::run() {
  initialise();
  if (!folders_.restart.empty()) load();
  StepActions actions;
  actions.attempt = [&](const Step& step) { return attempt(step); };
  actions.accept = [&](double time, int output) { accept(time, output); };
  actions.write_start = [&](int output) { ask_all(everyone(), {Op::write_output, {}, {}, 0, output, ""}); };
  actions.save = [&](const std::filesystem::path& folder) { save(folder); };
  actions.report = [&](const Step& step, double time) { report(step, time); };
  actions.advised_dt = [&] { return advised_dt(everyone()); };
  std::string problem = loop_.run(actions);
  enter_(Phase::finalise, {});
  log::info("{}", summary());
  finalise_all(everyone());
  return problem;
}

}  // namespace couplet
