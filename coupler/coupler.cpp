// SPDX-License-Identifier: Apache-2.0
// A coupled run from start to end; coupler/step contains the step.
#include "coupler/coupler.hpp"

#include <algorithm>
#include <limits>

#include "common/base/error.hpp"
#include "common/base/own_file.hpp"
#include "common/diagnostics/results.hpp"
#include "common/io/checkpoint.hpp"
#include "common/log/log.hpp"
#include "common/parallel/collective.hpp"
#include "coupler/exchange/partners.hpp"

namespace couplet::coupler {

Coupler::Coupler(MPI_Comm comm, const CouplingParameters& parameters,
                 const app::SimulationParameters& simulation,
                 std::vector<std::unique_ptr<coupling::Channel>> channels, CouplerFolders folders)
    : comm_(comm),
      parameters_(parameters),
      simulation_(simulation),
      folders_(std::move(folders)),
      loop_(comm, simulation, parameters.scheme.first, folders_.checkpoints),
      pass_(comm, parameters, std::move(channels)),
      scheme_(parameters.scheme),
      diagnostics_(parallel::comm_rank(comm), simulation.diagnostics) {
  start_acceleration();
}

void Coupler::initialise() {
  enter_(app::Phase::initialise, {});
  pass_.initialise(parameters_);
  unknown_.emplace(comm_, pass_.sides(), pass_.links(), pass_.group(), pass_.schedule().side_by_side);
  record_.emplace(comm_, parameters_, pass_);
  view_.emplace(comm_, parameters_, pass_, *unknown_, *record_, scheme_, last_, history_, last_dt_);
  pass_.exchange_initial_values();
  std::vector<coupling::Exchange> given = pass_.given();
  unknown_->scale(given);
  if (unknown_->complete(given) || unknown_->start_at_rest(given)) history_.now = unknown_->gather(given);
  pass_.set_given(std::move(given));
  coupling_diagnostics_ = coupling_diagnostics(*view_, diagnostics_);
  pass_.on_solved([this](std::size_t i, const coupling::Exchange& taken, const coupling::Exchange& given) {
    for (const auto& d : coupling_diagnostics_) d->received(i, taken, given);
  });
}

std::string Coupler::run() {
  initialise();
  const std::string stateless = without_state(simulation_.checkpoint_interval, pass_.partners());
  double restart_time = std::numeric_limits<double>::quiet_NaN();
  if (!folders_.restart.empty()) {
    load();
    restart_time = app::read_run_state(folders_.restart).time;
  }
  base::release_files();
  record_->open(folders_.output, simulation_.end_time, restart_time);
  const auto write = [&](double time, int output) {
    pass_.command_all({coupling::Op::write_output, {}, {}, time, output, ""});
  };
  app::StepActions actions;
  actions.attempt = [&](const coupling::Step& step) { return attempt(step); };
  actions.accept = [&](double time, int output) { accept(time, output); };
  actions.write_start = [&](int output) { write(0, output); };
  actions.write_stop = write;
  actions.save = [&](const std::filesystem::path& folder) { save(folder); };
  actions.stateless = stateless;
  actions.report = [&](const coupling::Step& step, double time) {
    record_->monitor().step(step, time, last_, pass_.partners());
  };
  actions.advised_dt = [&] { return advised_dt(pass_.everyone()); };
  actions.change = [&] {
    double most = coupling::StepReport::unknown;
    for (const Partner* p : pass_.everyone()) most = std::fmax(most, p->report.change);
    return most;
  };
  std::string problem = loop_.run(actions);
  finalise(problem);
  return problem;
}

namespace {

std::string without_advice(const std::string& reason) {
  const std::size_t end = std::min(reason.find(". Try "), reason.find(". Use "));
  return end == std::string::npos ? reason : reason.substr(0, end + 1);
}

}  // namespace

std::optional<app::StepFailure> Coupler::attempt(const coupling::Step& step) {
  for (const auto& d : coupling_diagnostics_)
    if (std::string reason = d->stop(); !reason.empty()) return app::StepFailure(std::move(reason), false);
  const long before = iterations_;
  auto failure = attempt_once(step);
  // Retries only failures of the iteration: no scheme helps a failed first pass.
  if (!failure || !failure->halving_helps || iterations_ - before < 2) return failure;
  if (!scheme_.failed()) return failure;
  auto learnt = std::move(accelerator_);
  start_acceleration();
  if (attempt_once(step)) {
    scheme_.withdraw();
    accelerator_ = std::move(learnt);
    return failure;
  }
  log::info("t = {:g} s: repeated as an implicit step: {}", step.time, without_advice(failure->reason));
  return {};
}

std::optional<app::StepFailure> Coupler::attempt_once(const coupling::Step& step) {
  enter_(app::Phase::begin_step, step.time);
  for (Partner* p : pass_.everyone()) p->seconds = 0;
  for (const auto& d : coupling_diagnostics_) d->begin_step();
  scheme_.start_step();
  try {
    solve(step);
  } catch (const SchemeFailure& failure) {
    if (std::ranges::all_of(pass_.partners(), &Partner::left)) {
      log::info("all programs have left the coupling at t = {:g} s, before its end", step.time);
      return app::StepFailure("", false);
    }
    return app::StepFailure(failure.what(), false);
  } catch (const SolveFailure& failure) {
    return cause_of(failure.what());
  }
  return {};
}

void Coupler::solve(const coupling::Step& step) {
  coupling::Step begun = step;
  begun.scheme = scheme_.now();
  pass_.begin_step(begun);
  enter_(app::Phase::solve, step.time);
  last_ = pass_.schedule().iterates ? iterate(step) : single_pass(step);
  pass_.keep_outputs();
  last_dt_ = step.dt;
}

/// Makes the step state n.
void Coupler::accept(double time, int output) {
  enter_(app::Phase::accept, {});
  pass_.command_all({coupling::Op::accept_step, {}, {}, time, output, ""});
  enter_(app::Phase::accept, time);
  last_.image = unknown_->end_values(std::move(last_.image));
  record_->balance();
  diagnostics_.accepted(time);
  history_.accepted(last_.image, last_dt_, pass_.schedule().predictor);
  if (VolumeLevel* level = pass_.volume_level()) level->accept(pass_.given());
  record_->accepted(time, pass_.volume_level());
  if (scheme_.accepted(time)) start_acceleration();
}

/// Findings of the coupling precede those of a participant, whose advice would not help.
app::StepFailure Coupler::cause_of(const std::string& reported) const {
  const std::string met = without_advice(reported);
  std::string remarks;
  for (const auto& d : coupling_diagnostics_) {
    if (const auto cause = d->suspects()) return {cause->reason + " Thereupon " + met, cause->halving_helps};
    remarks += d->remark();
  }
  return app::StepFailure(reported + remarks);
}

void Coupler::start_acceleration() {
  if (pass_.schedule().iterates) accelerator_ = make_accelerator(parameters_.acceleration, comm_);
}

/// `problem`: why the run stopped early; its error is then not judged.
void Coupler::finalise(const std::string& problem) {
  enter_(app::Phase::finalise, {});
  Monitor& monitor = record_->monitor();
  log::info("{}", monitor.summary(loop_.halvings()));
  diagnostics::set_result({.name = "coupling iterations per step, mean and most",
                           .unit = "1",
                           .values = monitor.iterations_per_step(),
                           .rank = 2});
  if (const std::string waiting = monitor.waiting(pass_.partners(), pass_.schedule()); !waiting.empty())
    log::info("{}", waiting);
  for (const std::string& line : diagnostics_.conclude(!problem.empty())) log::info("{}", line);
  std::vector<coupling::Exchange> last;
  for (std::size_t i = 0; i < pass_.partners().size(); ++i)
    last.push_back(pass_.links().input(i, pass_.given()));
  std::vector<diagnostics::NamedErrors> parts = finalise_all(pass_.everyone(), problem, std::move(last));
  if (simulation_.diagnostics != diagnostics::When::always && problem.empty()) {
    if (const diagnostics::ErrorParts& mine = diagnostics_.errors(); mine.known() || !mine.omittable.empty())
      parts.push_back({"coupling", mine});
    errors_ = diagnostics::largest(parts);
    for (const std::string& sentence : diagnostics::error_sentences(parts)) log::info("{}", sentence);
    if (const auto finding = diagnostics::worthless(parts))
      diagnostics::finding(parallel::comm_rank(comm_), *finding);
  }
  if (const std::string where = diagnostics::position_sentence(position()); !where.empty())
    log::info("{}", where);
  // The launcher prints the verdict, because the participants still have findings to report.
  if (problem.empty()) log::info("{}", diagnostics::results_text("coupler", loop_.time(), 2, errors_, {}));
}

std::vector<diagnostics::Coordinate> Coupler::position() const {
  if (!pass_.schedule().iterates) return diagnostics_.position();
  if (!(steps() > 0)) return {};
  return {{"coupling iterations per step", double(iterations()) / double(steps()),
           double(parameters_.convergence.max_iterations), "strong-robin"}};
}

void Coupler::visit(io::Archive archive) {
  const IterateOrder order = unknown_->order(false);
  for (const auto& [name, iterate] : {std::pair<std::string, Iterate*>{"now", &history_.now},
                                      {"old", &history_.old},
                                      {"older", &history_.older}}) {  // an iterate may be empty
    archive.field(order.unknown, name, iterate->unknown, 1);
    archive.field(order.dependent, name + "-dependent", iterate->dependent, 1);
  }
  archive.common("history", history_.old_dt, history_.older_dt, iterations_);
  std::vector<double> weights = unknown_->weights();
  std::array<double, 2> scheme = scheme_.state();
  archive.common("weights", weights);
  archive.common("scheme", scheme);
  if (archive.reads()) {
    unknown_->restore_weights(weights);
    scheme_.restore(scheme);
  }
  record_->visit(archive);
  if (accelerator_) accelerator_->visit(archive, unknown_->order(true));
  pass_.visit(archive);
  diagnostics_.visit(archive);
}

void Coupler::save(const std::filesystem::path& folder) {
  enter_(app::Phase::save, {});
  pass_.command_all({coupling::Op::save, {}, {}, 0, -1, folder.string()});
  io::CheckpointWriter file(comm_, folder / "coupler.h5");
  visit(io::Archive(file));
  file.close();
}

void Coupler::load() {
  enter_(app::Phase::load, {});
  io::CheckpointReader file(comm_, folders_.restart / "coupler.h5");
  visit(io::Archive(file));
  const app::RunState state = app::read_run_state(folders_.restart);
  loop_.restart(state, folders_.restart);
  pass_.command_all({coupling::Op::load, {}, {}, state.time, -1, folders_.restart.string()});
  log::info("continues from {} at t = {:g} s", folders_.restart.string(), state.time);
}

}  // namespace couplet::coupler
