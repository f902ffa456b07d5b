// SPDX-License-Identifier: Apache-2.0
#include "plate_modal/structure.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "common/base/error.hpp"
#include "common/log/log.hpp"
#include "common/mesh/load.hpp"
#include "plate_modal/results.hpp"

namespace couplet::plate {
namespace {

/// A direction says where to, not how far.
Parameters with_unit_directions(Parameters p) {
  p.placement.x.stableNormalize();
  p.placement.y.stableNormalize();
  if (p.contact && !p.contact->direction.empty()) {
    Eigen::Map<Vec3> direction(p.contact->direction.data());
    direction.stableNormalize();
  }
  return p;
}

}  // namespace

Structure::Structure(Parameters parameters, PlateContext context, const mesh::RawMesh* raw)
    : parameters_(with_unit_directions(std::move(parameters))),
      context_(std::move(context)),
      built_(build_model(parameters_, context_, raw)),
      share_(std::make_unique<Share>(context_.comm, built_.model)) {
  const Parameters& p = parameters_;
  if (parallel::comm_rank(context_.comm) == 0) {
    if (!built_.outline.empty()) log::warn("{}", built_.outline);
    if (!built_.note.empty()) log::warn("{}", built_.note);
    if (p.modes_file)
      log::info(
          "modes from a file: the contribution of truncated modes cannot be estimated. A load on few faces, "
          "or along a stiff direction, needs many: export twice as many, and compare.");
    if (built_.reused) log::info("reusing the modes of {}", (context_.output_folder / "modes.h5").string());
  }
  if (p.analysis == Parameters::Analysis::static_ && share_->omega().front() == 0)
    throw Error(
        "The structure moves as a rigid body (mode 1 has zero frequency): a static analysis needs supports "
        "that prevent this.");
  gravity_.assign(share_->n_modes(), 0);
  if (!p.gravity.empty()) gravity_ = share_->participation(Vec3(p.gravity.data()));
  if (p.contact) make_contact();
  if (p.load && (p.load->upper || p.load->lower))
    pressure_ = std::make_unique<PressureLoad>(*share_, *p.load, p.placement.normal(), context_.name);
  oscillators_ =
      std::make_unique<Oscillators>(share_->omega(), damping(), gravity_, p.time_scheme, contact_.get());
  state_ = trial_ = initial_state();
  if (contact_ && !p.contact->starts_inside) refuse_wound_springs();
  results_ = std::make_unique<PlateResults>(*this);
  displacement_ = share_->gather_vertices(state_.q);
}

Structure::~Structure() = default;

coupling::Interface Structure::initialise() {
  coupling::Interface interface = share_->describe();
  interface.takes = {{"pressure-force", "N", coupling::Interface::Place::faces},
                     {"viscous-force", "N", coupling::Interface::Place::faces}};
  interface.gives = {{"displacement", "m", coupling::Interface::Place::vertices},
                     {"velocity", "m/s", coupling::Interface::Place::vertices}};
  if (parameters_.surface_density)
    interface.gives.push_back({"surface-density", "kg/m^2", coupling::Interface::Place::faces, 1});
  results_->write_start();
  return interface;
}

/// A scheme that has made more energy than the structure ever had moves something else than the structure.
void Structure::refuse_made_energy() const {
  const double made = trial_.energies.mismatch(),
               had = std::max(trial_.energies.largest, trial_.energies.own());
  if (!(made > had)) return;
  throw SolveFailure(
      "At t = {:g} s the time scheme has generated {:.3g} J, more than the {:.3g} J that the structure had "
      "at most: the motion is spurious. Use {}.",
      step_.time + step_.dt, made, had,
      parameters_.contact && parameters_.contact->rule == ContactRule::midpoint
          ? "'contact.rule: conserving', or 'simulation.time-step' below a twentieth of a contact"
          : "a smaller 'simulation.time-step'");
}

coupling::Exchange Structure::solve(const coupling::Exchange& in) {
  std::vector<double> fluid(share_->n_modes(), 0);
  for (const char* name : {"pressure-force", "viscous-force"}) {
    const auto given = in.find(name);
    share_->add_load(share_->scatter_faces(given == in.end() ? std::vector<double>{} : given->second), fluid);
  }
  share_->sum(fluid);
  const auto given = in.find("pressure-force");
  fluid_force_ = given == in.end() ? std::vector<double>{} : given->second;
  pressure_acts_ = false;
  if (parameters_.analysis == Parameters::Analysis::dynamic) {
    // A partner's load is its mean over the step: that of the middle. Schemes that solve later continue it from the middle of the last step.
    const time::TimeScheme scheme = parameters_.time_scheme.type;
    const bool looks_back = time::uses_acceleration(scheme) || time::uses_old_level(scheme);
    const auto load = [&](double after, std::span<double> total) {
      if (pressure_)
        add_pressure(step_.time + after, total);
      else
        std::ranges::fill(total, 0);
      for (std::size_t m = 0; m < fluid.size(); ++m) total[m] += fluid[m];
      if (!looks_back || state_.partner.empty()) return;
      const double on = (after - 0.5 * step_.dt) / (0.5 * (step_.dt + state_.dt));
      for (std::size_t m = 0; m < fluid.size(); ++m) total[m] += on * (fluid[m] - state_.partner[m]);
    };
    oscillators_->step(state_, step_.dt, load, trial_);
    if (looks_back) trial_.partner = fluid;
    refuse_made_energy();
  } else if (parameters_.analysis == Parameters::Analysis::static_) {
    solve_static(step_.time + step_.dt, fluid);
  }
  coupling::Exchange out;
  std::vector<double> u = share_->gather_vertices(trial_.q), v = share_->gather_vertices(trial_.v);
  if (parallel::comm_rank(context_.comm) != 0) return out;
  trial_displacement_ = direct_.empty() ? u : direct_;
  out["displacement"] = std::move(u);
  out["velocity"] = std::move(v);
  if (parameters_.surface_density) out["surface-density"] = built_.model.face_density;
  return out;
}

void Structure::add_pressure(double t, std::span<double> load) {
  pressure_->at(t, load);
  pressure_acts_ = pressure_acts_ || std::ranges::any_of(load, [](double f) { return f != 0; });
}

/// q = Q / omega^2 of each mode; beside it K u = f on rank 0.
void Structure::solve_static(double t, std::span<const double> fluid) {
  std::vector<double> load(fluid.size(), 0);
  if (pressure_) add_pressure(t, load);
  for (std::size_t m = 0; m < load.size(); ++m) {
    trial_.q[m] = (load[m] + fluid[m] + gravity_[m]) / (share_->omega()[m] * share_->omega()[m]);
    trial_.v[m] = 0;
  }
  // Equal loads give the same answer again.
  const bool first = !repeats_;
  repeats_ = trial_.q == solved_ && trial_.q == state_.q;
  if (repeats_) {
    if (first && parallel::comm_rank(context_.comm) == 0)
      log::info("the loads do not change from step to step, so the constant deflection is written once");
    return;
  }
  solved_ = trial_.q;
  std::vector<double> by_modes = share_->gather_vertices(trial_.q);
  mesh::on_root(context_.comm, [&] {
    if (!built_.plate) return;
    direct_ = direct_deflection(t);
    Deflection& d = deflection_.emplace(Deflection{});
    for (std::size_t i = 0; i < direct_.size(); ++i) {
      d.direct = std::max(d.direct, std::abs(direct_[i]));
      d.by_modes = std::max(d.by_modes, std::abs(by_modes[i]));
      d.apart = std::max(d.apart, std::abs(direct_[i] - by_modes[i]));
    }
    log::info("static deflection: max {:.6e} m; by {} modes {:.6e} m; max difference {:.2e} m", d.direct,
              share_->n_modes(), d.by_modes, d.apart);
  });
}

std::vector<double> Structure::direct_deflection(double t) const {
  const PlateModel& plate = *built_.plate;
  const modes::EigenModes one{
      {0}, {plate.deflect(plate.load_of(cell_pressures(plate, parameters_, pressure_.get(), t)))}, 0, 0};
  return skin_of(plate, one, parameters_.placement, parameters_.wetted,
                 std::vector<bool>(plate.surface().patches.size(), false))
      .vertex_shape;
}

coupling::StepReport Structure::accept_step() {
  std::swap(state_, trial_);
  std::swap(displacement_, trial_displacement_);
  Energies& e = state_.energies;
  e.largest = std::max(e.largest, e.own());
  return {.dt = step_.dt, .iterations = oscillators_->newton_iterations(), .energy = e.total()};
}

void Structure::write_output(double time, int) { results_->write_fields(time); }
void Structure::write_monitors(double time) { results_->write_series(time); }

}  // namespace couplet::plate
