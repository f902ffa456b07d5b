// SPDX-License-Identifier: Apache-2.0
#include "common/app/run_report.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "common/app/loop/step_loop.hpp"
#include "common/base/error.hpp"
#include "common/base/own_file.hpp"
#include "common/coupling/channel.hpp"
#include "common/diagnostics/diagnostics.hpp"
#include "common/diagnostics/error_parts.hpp"
#include "common/diagnostics/finding.hpp"
#include "common/diagnostics/results.hpp"
#include "common/fv/use.hpp"
#include "common/io/checkpoint.hpp"
#include "common/log/log.hpp"
#include "common/log/progress.hpp"
#include "common/parallel/collective.hpp"

namespace couplet::app {
namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

Phase phase_of(coupling::Op op) {
  switch (op) {
    case coupling::Op::initialise:
      return Phase::initialise;
    case coupling::Op::begin_step:
      return Phase::begin_step;
    case coupling::Op::start:
    case coupling::Op::solve:
      return Phase::solve;
    case coupling::Op::accept_step:
      return Phase::accept;
    case coupling::Op::write_output:
      return Phase::output;
    case coupling::Op::save:
      return Phase::save;
    case coupling::Op::load:
      return Phase::load;
    case coupling::Op::finalise:
      return Phase::finalise;
  }
  return Phase::waiting;
}

/// Updates the watch over the job and the timers for each command.
class Bookkeeping {
 public:
  Bookkeeping(const Job& job, RunReport& report) : job_(job), report_(report) {}
  void waiting() {
    since_ = Clock::now();
    job_.enter(Phase::waiting);
  }
  void waited() { log::timers().add("waiting for the coupler", seconds_since(since_)); }
  void received(const coupling::Command& command) {
    since_ = Clock::now();
    processor_since_ = RunReport::processor_seconds();
    // The first command after the start shows that all participants have accepted the run.
    if (command.op == coupling::Op::begin_step || command.op == coupling::Op::write_output ||
        command.op == coupling::Op::finalise)
      release();
    if (command.op == coupling::Op::begin_step) job_.supervisor->set_time(command.step.time);
    job_.enter(phase_of(command.op));
  }
  /// Until the files are there, an error is one of the start.
  void release() {
    job_.supervisor->enter(Phase::initialise);
    base::release_files();
  }
  void done(const coupling::Command& command) {
    const double seconds = seconds_since(since_);
    log::timers().add(couplet::coupling::name(command.op), seconds);
    report_.spent(seconds, RunReport::processor_seconds() - processor_since_);
    if (command.op == coupling::Op::accept_step) job_.supervisor->set_time(command.time);
  }

 private:
  const Job& job_;
  RunReport& report_;
  Clock::time_point since_ = Clock::now();
  double processor_since_ = 0;
};

/// Participant with its diagnostics, which observe each accepted step and save their memory with its state.
class Observed final : public coupling::Participant {
 public:
  Observed(coupling::Participant& inner, diagnostics::Diagnostics& diagnostics, const Diagnose& diagnose,
           const SimulationParameters& simulation)
      : inner_(inner),
        diagnostics_(diagnostics),
        diagnose_(diagnose),
        looks_for_rest_(simulation.until_steady.has_value()) {}
  coupling::Interface initialise() override {
    coupling::Interface interface = inner_.initialise();
    if (diagnose_) diagnose_(inner_, diagnostics_);
    return interface;
  }
  double suggest_dt() override { return inner_.suggest_dt(); }
  void begin_step(const coupling::Step& step) override {
    end_ = step.time + step.dt;
    inner_.begin_step(step);
  }
  coupling::Exchange solve(const coupling::Exchange& in) override { return inner_.solve(in); }
  bool renewed_prediction() const override { return inner_.renewed_prediction(); }
  coupling::StepReport accept_step() override {
    coupling::StepReport report = inner_.accept_step();
    if (looks_for_rest_) report.change = inner_.change();
    if (!std::isnan(report.energy)) {
      fv::Use& energy = fv::uses()["energy"];
      energy.kind = fv::Use::Kind::energy;
      energy.note(report.energy);
    }
    diagnostics_.accepted(end_);
    return report;
  }
  void save(io::CheckpointWriter& file) const override {
    inner_.save(file);
    io::Archive archive(file);
    diagnostics_.visit(archive);
  }
  void load(io::CheckpointReader& file) override {
    inner_.load(file);
    io::Archive archive(file);
    diagnostics_.visit(archive);
  }
  void write_output(double time, int number) override {
    inner_.write_output(time, number);
    const log::ScopedTimer timer(log::timers(), "diagnostics");
    diagnostics_.look();
  }
  void write_monitors(double time) override { inner_.write_monitors(time); }

 private:
  coupling::Participant& inner_;
  diagnostics::Diagnostics& diagnostics_;
  const Diagnose& diagnose_;
  const bool looks_for_rest_;
  double end_ = 0;  // of the current step [s]
};

/// Options of the closing report of a run.
struct Closing {
  bool is_alone = true;  ///< the error of the job is that of this program; else the coupler reports it
  /// The run failed. Neglected effects then count only if they were not sound, and no error is estimated.
  bool has_failed = false;
};

/// Rows of the results, so that a run that ends shows them all on a terminal of 24 lines.
constexpr std::size_t most_results = 14, most_of_participant = 5;

void closing_words(const Job& job, coupling::Participant& participant, diagnostics::Diagnostics& diagnostics,
                   const Closing& closing, double seconds, double time) {
  std::vector<std::string> sentences = participant.finish();
  for (std::string& line : diagnostics.conclude(closing.has_failed)) sentences.push_back(std::move(line));
  if (closing.has_failed)
    sentences.push_back(
        "the run failed: its error and neglected effects are not judged, except as reported above.");
  const std::vector<diagnostics::NamedErrors> errors{{job.name, diagnostics.errors()}};
  for (std::string& line : diagnostics::error_sentences(errors)) {
    sentences.push_back(std::move(line));
    if (!closing.is_alone) break;
  }
  if (std::string where = diagnostics::position_sentence(diagnostics.position()); !where.empty())
    sentences.push_back(std::move(where));
  if (closing.is_alone)
    if (const auto finding = diagnostics::worthless(errors)) diagnostics::finding(job.rank, *finding);
  const double mine = RunReport::peak_memory();
  const double most = parallel::max(job.comm, mine), all = parallel::sum(job.comm, mine);
  if (job.rank != 0) return;
  for (const std::string& sentence : sentences) log::info("{}", sentence);
  log::info("{}", log::timers().table("time of '" + job.name + "'", seconds));
  log::info("peak memory of '{}': {:.0f} MB on the rank with the most, {:.0f} MB in total", job.name, most,
            all);
  const bool judges = closing.is_alone && !closing.has_failed;
  log::info("{}",
            diagnostics::results_text(job.name, time, closing.is_alone ? most_results : most_of_participant,
                                      diagnostics.errors(),
                                      judges ? diagnostics::verdict(errors) : std::vector<std::string>()));
}

/// Sends commands from the participant's own loop, with the bookkeeping of a coupled run.
class OwnCommands {
 public:
  OwnCommands(const Job& job, coupling::Participant& participant, RunReport& run)
      : job_(job), participant_(participant), run_(run), books_(job, run) {}
  coupling::Reply operator()(const coupling::Command& command) {
    books_.received(command);
    const coupling::Reply reply = coupling::carry_out(command, participant_, job_.name, job_.comm);
    books_.done(command);
    if (reply.status == coupling::Reply::Status::ok) advised_dt_ = std::min(reply.suggested_dt, advised_dt_);
    seconds_ += reply.seconds;
    if (command.op == coupling::Op::accept_step) {
      report_ = reply.report;
      report_.seconds = std::exchange(seconds_, 0.0);
      run_.accepted(command.time, reply.report);
    }
    return reply;
  }
  std::optional<StepFailure> attempt(const coupling::Step& step) {
    coupling::Command command{coupling::Op::begin_step, step, {}, 0, -1, ""};
    for (const coupling::Op op : {coupling::Op::begin_step, coupling::Op::solve}) {
      command.op = op;
      if (const coupling::Reply reply = (*this)(command); reply.status != coupling::Reply::Status::ok)
        return StepFailure(reply.text, reply.status != coupling::Reply::Status::hopeless);
    }
    return {};
  }
  void accept(double time, int output) {
    advised_dt_ = std::numeric_limits<double>::infinity();
    must({coupling::Op::accept_step, {}, {}, time, output, ""});
  }
  /// Executes a command other than a step. Its failure ends the run.
  void must(const coupling::Command& command) {
    const coupling::Reply reply = (*this)(command);
    if (reply.status != coupling::Reply::Status::ok) throw SolveFailure(reply.text);
  }
  double advised_dt() const { return advised_dt_; }
  /// Report on the last accepted step.
  const coupling::StepReport& report() const { return report_; }

 private:
  const Job& job_;
  coupling::Participant& participant_;
  RunReport& run_;
  Bookkeeping books_;
  coupling::StepReport report_;
  double seconds_ = 0;  // since the last accepted step
  double advised_dt_ = std::numeric_limits<double>::infinity();
};

/// Prints a line at most twice per second, and at the end.
class Console {
 public:
  explicit Console(const SimulationParameters& simulation) : end_(simulation.end_time) {}
  void step(const coupling::Step& step, double time) {
    if (!begun_) begun_ = {Clock::now(), time};
    if (seconds_since(last_) < 0.5 && time < end_) return;
    last_ = Clock::now();
    // The time before the second step (meshes, factors, modes) is not representative of a step.
    const std::string eta =
        time < end_ && time == begun_->second
            ? ""
            : log::eta(time - begun_->second, end_ - begun_->second, seconds_since(begun_->first));
    log::info("t={:g}/{:g} s  step {}  dt={:g} s  {}", time, end_, step.number + 1, step.dt, eta);
  }
  double seconds() const { return seconds_since(start_); }

 private:
  double end_;
  Clock::time_point start_ = Clock::now(), last_{};
  std::optional<std::pair<Clock::time_point, double>> begun_;  // when the first step was done, and its time
};

}  // namespace

int run_alone(const Job& job, coupling::Participant& participant, const Diagnose& diagnose) {
  RunReport run(job);
  diagnostics::Diagnostics diagnostics(job.rank, job.simulation.diagnostics);
  diagnostics.add("use-of-case", use_of_case(job.comm));
  Observed observed(participant, diagnostics, diagnose, job.simulation);
  OwnCommands command(job, observed, run);
  StepLoop loop(job.comm, job.simulation, coupling::Scheme::standalone, job.checkpoints);
  Console console(job.simulation);
  command.must({coupling::Op::initialise, {}, {}, 0, -1, ""});
  if (!job.restart_folder.empty()) {
    command.must({coupling::Op::load, {}, {}, 0, -1, job.restart_folder.string()});
    loop.restart(read_run_state(job.restart_folder), job.restart_folder);
    log::info("continues from {} at t = {:g} s", job.restart_folder.string(), job.restart_time);
  }
  StepActions actions;
  actions.attempt = [&](const coupling::Step& step) { return command.attempt(step); };
  actions.accept = [&](double time, int output) { command.accept(time, output); };
  actions.write_start = [&](int output) {
    command.must({coupling::Op::write_output, {}, {}, 0, output, ""});
  };
  actions.write_stop = [&](double time, int output) {
    command.must({coupling::Op::write_output, {}, {}, time, output, ""});
  };
  actions.save = [&](const std::filesystem::path& folder) {
    command.must({coupling::Op::save, {}, {}, 0, -1, folder.string()});
  };
  actions.report = [&](const coupling::Step& step, double time) { console.step(step, time); };
  actions.advised_dt = [&] { return command.advised_dt(); };
  actions.change = [&] { return command.report().change; };
  const std::string problem = loop.run(actions);
  job.enter(Phase::finalise);
  closing_words(job, participant, diagnostics, {.has_failed = !problem.empty()}, console.seconds(),
                loop.time());
  run.finish(console.seconds(), problem, diagnostics.errors(), diagnostics.position());
  if (job.rank == 0) log::log_where(job.output_folder.string(), job.name + ".log");
  if (problem.empty()) return 0;
  if (job.rank == 0) log::error("{}", problem);
  return 1;
}

int run_coupled(const Job& job, MPI_Comm coupler, coupling::Participant& participant,
                const Diagnose& diagnose) {
  const auto start = Clock::now();
  RunReport run(job);
  diagnostics::Diagnostics diagnostics(job.rank, job.simulation.diagnostics);
  diagnostics.add("use-of-case", use_of_case(job.comm));
  Observed observed(participant, diagnostics, diagnose, job.simulation);
  Bookkeeping books(job, run);
  coupling::ServeObserver observer;
  observer.waiting = [&] { books.waiting(); };
  observer.received = [&](const coupling::Command& command) {
    books.waited();
    books.received(command);
    if (command.op != coupling::Op::finalise) return;
    closing_words(job, participant, diagnostics, {.is_alone = false, .has_failed = !command.folder.empty()},
                  seconds_since(start), run.time());
    run.finish(seconds_since(start), "", diagnostics.errors(), diagnostics.position());
  };
  observer.last_word = [&] { return diagnostics.errors().text(); };
  observer.done = [&](const coupling::Command& command) { books.done(command); };
  observer.accepted = [&](const coupling::Command& command, const coupling::StepReport& report) {
    run.accepted(command.time, report);
  };
  coupling::serve(coupler, job.comm, job.name, observed, observer);
  return 0;
}

}  // namespace couplet::app
