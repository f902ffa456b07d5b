// SPDX-License-Identifier: Apache-2.0
#include "solid_solver/solid.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "common/base/error.hpp"
#include "common/diagnostics/results.hpp"
#include "common/elasticity/vector_at.hpp"
#include "common/fv/use.hpp"
#include "common/io/checkpoint.hpp"
#include "common/io/probes/probe.hpp"
#include "solid_solver/output/quantities.hpp"

namespace couplet::solid {

Solid::Solid(mesh::LoadedMesh body, SolidParameters parameters, SolidContext context)
    : context_(std::move(context)),
      body_(std::move(body), std::move(parameters)),
      interface_(body_),
      stepper_(body_),
      fields_(body_, stepper_.state(), stepper_.last_solve()),
      output_(fields_, stepper_, body_, context_),
      is_loaded_by_case_(!body_.parameters().heat && body_.parameters().output.modes == 0 &&
                         body_.boundaries().interface_patches().empty()) {
  for (const auto& [name, quantity] :
       body_.parameters().quantities)  // a place outside is an error now, not at the end
    if (!quantity.point.empty()) io::Probe(body_.mesh(), body_.geometry().points, name, place_of(quantity));
}

void Solid::begin_step(const coupling::Step& step) {
  stepper_.begin_step(step, !interface_.takes_temperature());
  if (!body_.is_dynamic() || step.number != 0) return;
  if (body_.parameters().output.spectrum) output_.write_spectrum(step.dt);
  if (body_.parameters().output.modes > 0) output_.write_modes();
}

coupling::Exchange Solid::solve(const coupling::Exchange& in) {
  if (interface_.takes_temperature()) {
    interface_.take_temperature(in);
    stepper_.prepare_loads();
  }
  stepper_.solve(interface_.load(in));
  return interface_.values(stepper_.trial(), stepper_.step().dt);
}

coupling::StepReport Solid::accept_step() {
  stepper_.accept_step();
  ThermalStrain* thermal = body_.thermal();
  if (thermal && thermal->wants_stress())
    thermal->take_stress(fields_.cell_stress(fields_.point_displacement()));
  if (is_loaded_by_case_) {  // a run at rest is a finding
    fv::Use& motion = fv::uses()["energy"];
    motion.kind = fv::Use::Kind::energy;
    double largest = 0;
    for (const double u : stepper_.state().cell_u) largest = std::max(largest, std::abs(u));
    motion.note(largest);
  }
  return {.dt = stepper_.state().dt, .iterations = stepper_.effort().iterations};
}

std::vector<std::string> Solid::finish() {
  const SolidOutputParameters& chosen = body_.parameters().output;
  if (chosen.buckling > 0) output_.write_buckling();
  if (chosen.modes > 0 && !body_.is_dynamic()) output_.write_preloaded_modes();
  const int dim = body_.mesh().dim;
  const std::vector<double> u = fields_.point_displacement();
  std::pair<double, Vec3> most{0, Vec3::Zero()};
  for (Index v = 0; v < body_.mesh().points.n_owned(); ++v)
    if (const double size = elastic::vector_at(u, v, dim).norm(); size > most.first)
      most = {size, body_.geometry().points[v]};
  diagnostics::set_largest(body_.mesh().comm, "largest displacement", "m", most.first, most.second);
  return {};
}

void Solid::write_output(double time, int number) {
  stepper_.release_solver();
  output_.write_fields(time, number, fields_.point_displacement());
}

void Solid::write_monitors(double time) {
  stepper_.release_solver();
  output_.write_series(time, fields_.point_displacement());
}

void Solid::save(io::CheckpointWriter& file) const {
  stepper_.save_state(file);
  if (body_.thermal()) body_.thermal()->save(file);
  stepper_.save_guesses(file);
}

void Solid::load(io::CheckpointReader& file) {
  stepper_.load_state(file);
  if (body_.thermal()) body_.thermal()->load(file);
  body_.place_expansion(stepper_.state().time);
  stepper_.load_guesses(file);
}

}  // namespace couplet::solid
