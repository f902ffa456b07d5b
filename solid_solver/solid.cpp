// SPDX-License-Identifier: Apache-2.0
#include "solid_solver/solid.hpp"

#include <cmath>
#include <utility>

#include "common/base/error.hpp"
#include "common/io/archive.hpp"
#include "common/io/checkpoint.hpp"
#include "common/io/probes/probe.hpp"
#include "common/log/log.hpp"
#include "solid_solver/output/output.hpp"

namespace couplet::solid {
namespace {

constexpr int steps_between_looks = 50;  // of a motion at its energy; a look costs less than a step

}  // namespace

Solid::Solid(mesh::LoadedMesh body, SolidParameters parameters, SolidContext context)
    : context_(std::move(context)),
      body_(std::move(body), std::move(parameters)),
      interface_(body_),
      stepper_(body_),
      fields_(body_, stepper_.state(), stepper_.last_solve()),
      judge_(body_, stepper_, fields_),
      output_(std::make_unique<SolidOutput>(fields_, stepper_, body_, context_)) {
  for (const auto& [name, quantity] :
       body_.parameters().quantities)  // a place outside is an error now, not at the end
    if (!quantity.point.empty()) io::Probe(body_.mesh(), body_.geometry().points, name, place_of(quantity));
}

Solid::~Solid() = default;

void Solid::begin_step(const coupling::Step& step) {
  const SolidOutputParameters& chosen = body_.parameters().output;
  dt_ = step.dt, is_last_ = step.is_last;
  stepper_.begin_step(step, !interface_.takes_temperature());
  if (chosen.spectrum && body_.is_dynamic() && step.number == 0) output_->write_spectrum(step.dt);
  if (chosen.modes > 0 && body_.is_dynamic() && step.number == 0) output_->write_modes(errors_.has_value());
}

coupling::Exchange Solid::solve(const coupling::Exchange& in) {
  if (interface_.takes_temperature()) {
    interface_.take_temperature(in);
    stepper_.prepare_loads();
  }
  stepper_.solve(interface_.load(in));
  return interface_.values(stepper_.trial(), dt_);
}

coupling::StepReport Solid::accept_step() {
  if (!body_.is_dynamic()) judge_.see_inertia();
  judge_.see_equilibrium();
  if (body_.parameters().output.large_strain_estimate) judge_.estimate_large_strain();
  if (errors_) errors_->see_step();
  stepper_.accept_step();
  if (!body_.is_dynamic()) {
    judge_.look();
    judge_.see_buckling();
    judge_.follow_path();
  }
  if (is_last_) estimate_quantities();
  stepper_.release_solver();
  for (const auto& effect : body_.effects())
    if (effect->wants_stress()) effect->take_stress(fields_.cell_stress(fields_.point_displacement()));
  return {.dt = stepper_.state().dt, .iterations = stepper_.effort().iterations};
}

/// While there is what the state was solved with.
void Solid::estimate_quantities() {
  if (body_.parameters().quantities.empty() || !stepper_.method()) return;
  try {
    quantities_ = solid::estimate_quantities(body_, fields_, stepper_.state(), *stepper_.method());
  } catch (const SolveFailure& failure) {
    log::warn("quantities: the estimate failed: {}", failure.what());
  }
}

void Solid::collect_errors() {
  errors_.emplace(body_, stepper_, fields_, judge_);
  for (const auto& effect : body_.effects()) effect->collect_errors();
}

diagnostics::ErrorParts Solid::error_parts() const {
  if (!errors_) return {};
  const diagnostics::ErrorParts parts = parts_ ? *parts_ : errors_->parts();
  // Here, where the mesh's part has just been estimated, which costs more than the stresses do.
  if (stepper_.state().steps > 0) output_->tell_stresses(parts.mesh);
  return parts;
}

std::vector<std::string> Solid::finish() {
  if (body_.is_dynamic()) {
    judge_.look();
    judge_.see_buckling();
  }
  const SolidOutputParameters& chosen = body_.parameters().output;
  if (chosen.buckling > 0) output_->write_buckling();
  if (chosen.modes > 0 && !body_.is_dynamic()) output_->write_preloaded_modes();
  std::vector<std::string> sentences = judge_.sentences();
  judge_.finish_path(sentences);
  if (!is_last_) estimate_quantities();  // a partner's load may be the last
  if (errors_ && !quantities_.empty()) {
    parts_ = errors_->parts();
    for (QuantityEstimate& q : quantities_) q.body = parts_->mesh > 0 ? parts_->mesh * std::abs(q.value) : 0;
  }
  tell_quantities(body_.mesh().comm, context_, quantities_);
  for (const auto& effect : body_.effects()) effect->judge(sentences);
  return sentences;
}

void Solid::write_output(double time, int number) {
  const std::vector<double> points = fields_.point_displacement();
  judge_.see_gradient(points);
  if (body_.is_dynamic()) judge_.look();
  output_->write_fields(time, number, points);
}

void Solid::write_monitors(double time) {
  // Growth out of nothing may come, or come and go, between two outputs.
  if (body_.is_dynamic() &&
      (body_.parameters().output.energies || stepper_.state().steps % steps_between_looks == 0))
    judge_.look();
  output_->write_series(time, fields_.point_displacement());
}

void Solid::save(io::CheckpointWriter& file) const {
  stepper_.save_state(file);
  io::Archive archive(file);
  const_cast<SolidJudge&>(judge_).visit(archive);  // writing changes nothing
  for (const auto& effect : body_.effects()) effect->save(file);
  stepper_.save_guesses(file);
  file.write_scalar("has-errors", errors_ ? 1 : 0);
  if (errors_) errors_->save(file);
}

void Solid::load(io::CheckpointReader& file) {
  stepper_.load_state(file);
  io::Archive archive(file);
  judge_.visit(archive);
  for (const auto& effect : body_.effects()) effect->load(file);
  body_.place_expansion(stepper_.state().time);
  stepper_.load_guesses(file);
  if (file.read_scalar("has-errors") != 0 && errors_) errors_->load(file);
}

}  // namespace couplet::solid
