// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common/app/step_loop.hpp"
#include "common/app/watch.hpp"
#include "common/io/series.hpp"
#include "coupler/coupler.hpp"
#include "coupler/links.hpp"
#include "coupler/partners.hpp"

namespace couplet {

/// Any number of participants that exchange data once a step (explicit): in the order of the list each takes
/// what the others gave last, i.e. values at t^{n+1} from those before it and at t^n from those after it
/// (serial), or all take values at t^n and work at the same time (parallel). In the first step data that
/// nobody has given yet are missing from what a participant takes.
class ExchangeRun {
 public:
  ExchangeRun(const CouplingParameters& parameters, const SimulationParameters& simulation,
              std::vector<std::unique_ptr<Channel>> channels, CouplerFolders folders);
  /// Called when the coupler turns to another phase, with the time if there is one.
  void on_phase(std::function<void(Phase, std::optional<double>)> callback) { enter_ = std::move(callback); }
  /// Initialises, runs, finalises. Returns an empty text, or why the run stopped before its end.
  std::string run();

  /// What each gave in the last accepted step, in the order of the list.
  const std::vector<Exchange>& given() const { return given_; }

 private:
  using Clock = std::chrono::steady_clock;
  std::vector<Partner*> everyone();
  void initialise();
  std::optional<std::string> attempt(const Step& step);
  void accept(double time, int output);
  void save(const std::filesystem::path& folder);
  void load();
  void report(const Step& step, double time);
  void write_amounts(double time);
  std::string summary() const;

  CouplingParameters parameters_;
  SimulationParameters simulation_;
  CouplerFolders folders_;
  std::vector<Partner> partners_;
  std::optional<Links> links_;
  StepLoop loop_;
  std::vector<Exchange> given_, trial_;  // by participant: accepted, of the step under way
  std::optional<Series> amounts_;
  double start_time_ = 0;
  bool restarted_ = false;
  Clock::time_point start_ = Clock::now(), last_line_{};
  std::vector<double> total_;  // seconds of each participant over the run
  std::function<void(Phase, std::optional<double>)> enter_ = [](Phase, std::optional<double>) {};
};

}  // namespace couplet
