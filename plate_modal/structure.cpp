// SPDX-License-Identifier: Apache-2.0
#include "plate_modal/structure.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "common/base/error.hpp"
#include "common/base/numbers.hpp"
#include "common/base/own_file.hpp"
#include "common/io/checkpoint.hpp"
#include "common/log/log.hpp"
#include "common/mesh/load.hpp"
#include "plate_modal/results.hpp"

namespace couplet::plate {
namespace {

/// Normalizes directions.
Parameters with_unit_directions(Parameters p) {
  p.placement.x.stableNormalize();
  p.placement.y.stableNormalize();
  if (p.contact && !p.contact->direction.empty()) {
    Eigen::Map<Vec3> direction(p.contact->direction.data());
    direction.stableNormalize();
  }
  return p;
}

/// A restart may change the material, the seat or gravity. The energy balance then starts from the energy in the new case.
void take_changed_energy(const Oscillators& oscillators, bool tells, ModalState& state) {
  Energies& kept = state.energies;
  const Energies now = oscillators.start(state.q, state.v).energies;
  const double scale =
      std::abs(kept.kinetic) + std::abs(kept.strain) + std::abs(kept.gravity) + std::abs(kept.contact);
  const double jump = now.total() - kept.total();
  if (!(std::abs(jump) > 1e-9 * scale)) return;
  if (tells)
    log::warn(
        "energy: after the changes of this restart the structure has {:.4g} J instead of {:.4g} J; this jump is not part of "
        "the balance.",
        now.total(), kept.total());
  kept.kinetic = now.kinetic, kept.strain = now.strain, kept.gravity = now.gravity,
  kept.contact = now.contact;
  kept.initial += jump;
}

}  // namespace

Structure::Structure(Parameters parameters, PlateContext context, const mesh::RawMesh* raw)
    : parameters_(with_unit_directions(std::move(parameters))),
      context_(std::move(context)),
      built_(build_model(parameters_, context_, raw)),
      surface_(std::move(built_.model)) {
  const Parameters& p = parameters_;
  if (parallel::comm_rank(context_.comm) == 0) {
    if (!built_.outline.empty()) log::warn("{}", built_.outline);
    if (!built_.note.empty()) log::warn("{}", built_.note);
    if (p.modes_file)
      log::info(
          "modes from a file: the contribution of truncated modes cannot be estimated. A load on few faces, or along a stiff "
          "direction, needs many modes: export twice as many, and compare.");
    if (built_.reused) log::info("reusing the modes of {}", (context_.output_folder / "modes.h5").string());
  }
  if (p.analysis == Parameters::Analysis::static_ && surface_.omega().front() == 0)
    throw Error(
        "The structure moves as a rigid body (mode 1 has zero frequency): a static analysis needs supports that prevent this.");
  gravity_.assign(surface_.n_modes(), 0);
  if (!p.gravity.empty()) gravity_ = surface_.participation(Vec3(p.gravity.data()));
  if (p.contact) make_contact();
  if (p.load && (p.load->upper || p.load->lower))
    pressure_ = std::make_unique<PressureLoad>(surface_, *p.load, p.placement.normal(), context_.name);
  oscillators_ =
      std::make_unique<Oscillators>(surface_.omega(), damping(), gravity_, p.time_scheme, contact_.get());
  state_ = trial_ = initial_state();
  if (contact_ && !p.contact->starts_inside) refuse_wound_springs();
  results_ = std::make_unique<PlateResults>(*this);
  displacement_ = surface_.motion(state_.q);
}

Structure::~Structure() = default;

/// Rejects an initial penetration of the seat, because its springs would store energy.
void Structure::refuse_wound_springs() const {
  double size = 0;
  for (const Vec3& x : surface_.centres()) size = std::max(size, (x - surface_.centres().front()).norm());
  const Contact::DeepestPoint place = contact_->deepest(state_.q);
  if (place.depth <= 1e-9 * size) return;
  throw Error(
      "contact: initially the structure is {:.3g} m inside the seat, deepest at ({:g}, {:g}, {:g}). Lower 'height' (it is "
      "measured from the origin along the direction; a side of a plate is half a thickness from its mid-surface), or set "
      "'starts-inside: true' if these springs are meant to push from the start.",
      place.depth, place.centre.x(), place.centre.y(), place.centre.z());
}

/// Creates the seat and recommends a step size for it.
void Structure::make_contact() {
  const Parameters& p = parameters_;
  contact_ = std::make_unique<Contact>(surface_, *p.contact, p.placement.normal(),
                                       p.contact->stiffness ? 0 : seat_stiffness(p));
  const double shortest = std::numbers::pi / std::sqrt(contact_->largest_stiffness());
  if (parallel::comm_rank(context_.comm) != 0) return;
  const double steps = shortest / context_.time_step;
  const std::string text = fmt::format(
      "contact over all faces lasts {:.3g} s (pi sqrt(m / kappa)), and contact over some of them lasts longer",
      shortest);
  if (std::isnan(steps))
    log::info("{}.", text);
  else if (steps >= 10)
    log::info("{}. The time step resolves it with {:.3g} steps.", text, steps);
  else
    log::warn(
        "{}. The time step resolves it with only {:.2g} steps. Twenty steps give the rebound speed to 1 %: "
        "'simulation.time-step: {:.2g} s'.",
        text, steps, shortest / 20);
}

std::vector<double> Structure::damping() const {
  const Damping d = parameters_.damping.value_or(Damping{});
  std::vector<double> c;
  for (const double omega : surface_.omega())
    c.push_back(2 * d.ratio * omega + d.mass + d.stiffness * omega * omega);
  return c;
}

ModalState Structure::initial_state() const {
  std::vector<double> q(surface_.n_modes(), 0), v = surface_.participation(parameters_.initial_velocity);
  if (std::ssize(parameters_.initial_amplitudes) > std::ssize(q))
    throw Error("initial-amplitudes: {} are given for {} modes.", parameters_.initial_amplitudes.size(),
                q.size());
  for (std::size_t m = 0; m < parameters_.initial_amplitudes.size(); ++m)
    q[m] = parameters_.initial_amplitudes[m] / modes::largest_displacement(model(), m);
  return oscillators_->start(std::move(q), std::move(v));
}

coupling::Interface Structure::initialise() {
  coupling::Interface interface;
  interface.dim = 3;
  if (parallel::comm_rank(context_.comm) == 0) interface = surface_.describe();
  interface.takes = {{"pressure-force", "N", coupling::Interface::Place::faces},
                     {"viscous-force", "N", coupling::Interface::Place::faces}};
  interface.gives = {{"displacement", "m", coupling::Interface::Place::vertices},
                     {"velocity", "m/s", coupling::Interface::Place::vertices}};
  base::when_started([this] { results_->write_start(); });
  return interface;
}

/// Throws if the scheme created more energy than the structure ever had.
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

/// Distributes rank 0's forces on the faces, 3 each, to all ranks; empty if there are none.
std::vector<double> Structure::received(const coupling::Exchange& in, const char* name) const {
  const auto given = in.find(name);
  std::vector<double> force = given == in.end() ? std::vector<double>{} : given->second;
  mesh::broadcast(context_.comm, force);
  if (!force.empty() && force.size() != 3 * surface_.n_faces())
    throw Error("The structure received {} force values, but its surface has {} faces with 3 components.",
                force.size(), surface_.n_faces());
  return force;
}

coupling::Exchange Structure::solve(const coupling::Exchange& in) {
  std::vector<double> fluid(surface_.n_modes(), 0);
  fluid_force_ = received(in, "pressure-force");
  const std::vector<double> viscous = received(in, "viscous-force");
  fluid_force_.resize(std::max(fluid_force_.size(), viscous.size()), 0.);
  for (std::size_t i = 0; i < viscous.size(); ++i) fluid_force_[i] += viscous[i];
  surface_.add_load(fluid_force_, fluid);
  if (parameters_.analysis == Parameters::Analysis::dynamic) {
    // A partner's load is its mean over the step, valid at mid-step; schemes that solve later extrapolate it.
    const time::TimeScheme scheme = parameters_.time_scheme.type;
    const bool looks_back = time::uses_acceleration(scheme) || time::uses_old_level(scheme);
    const auto load = [&](double after, std::span<double> total) {
      if (pressure_)
        pressure_->at(step_.time + after, total);
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
  std::vector<double> u = surface_.motion(trial_.q);
  trial_displacement_ = direct_.empty() ? u : direct_;
  if (parallel::comm_rank(context_.comm) != 0) return out;
  out["displacement"] = std::move(u);
  std::vector<double> rate = trial_.v;  // without inertia: that of the step
  if (parameters_.analysis == Parameters::Analysis::static_)
    for (std::size_t m = 0; m < rate.size(); ++m) rate[m] = (trial_.q[m] - state_.q[m]) / step_.dt;
  out["velocity"] = surface_.motion(rate);
  return out;
}

/// q = Q/omega^2 of each mode; K u = f on rank 0.
void Structure::solve_static(double t, std::span<const double> fluid) {
  std::vector<double> load(fluid.size(), 0);
  if (pressure_) pressure_->at(t, load);
  for (std::size_t m = 0; m < load.size(); ++m) {
    trial_.q[m] = (load[m] + fluid[m] + gravity_[m]) / (surface_.omega()[m] * surface_.omega()[m]);
    trial_.v[m] = 0;
  }
  // Equal loads give the same result.
  const bool first = !repeats_;
  repeats_ = trial_.q == solved_ && trial_.q == state_.q;
  if (repeats_) {
    if (first && parallel::comm_rank(context_.comm) == 0)
      log::info("the loads do not change from step to step, so the constant deflection is written once");
    return;
  }
  solved_ = trial_.q;
  mesh::on_root(context_.comm, [&] {
    if (built_.plate) direct_ = direct_deflection(t);
  });
  mesh::broadcast(context_.comm, direct_);
  if (direct_.empty()) return;
  const std::vector<double> by_modes = surface_.motion(trial_.q);
  Deflection& d = deflection_.emplace(Deflection{});
  for (std::size_t i = 0; i < direct_.size(); ++i) {
    d.direct = std::max(d.direct, std::abs(direct_[i]));
    d.by_modes = std::max(d.by_modes, std::abs(by_modes[i]));
    d.apart = std::max(d.apart, std::abs(direct_[i] - by_modes[i]));
  }
  if (parallel::comm_rank(context_.comm) == 0)
    log::info("static deflection: max {:.6e} m; with {} modes {:.6e} m; max difference {:.2e} m", d.direct,
              surface_.n_modes(), d.by_modes, d.apart);
}

std::vector<double> Structure::direct_deflection(double t) const {
  const PlateModel& plate = *built_.plate;
  const modes::EigenModes one{
      {0},
      {plate.deflect(plate.load_of(cell_pressures(plate, parameters_, pressure_.get(), fluid_force_, t)))},
      0,
      0};
  return skin_of(plate, one, parameters_.placement, parameters_.wetted,
                 std::vector<bool>(plate.surface().patches.size(), false))
      .vertex_shape;
}

coupling::StepReport Structure::accept_step() {
  std::swap(state_, trial_);
  std::swap(displacement_, trial_displacement_);
  Energies& e = state_.energies;
  e.largest = std::max(e.largest, e.own());
  coupling::StepReport report{.dt = step_.dt, .iterations = oscillators_->newton_iterations()};
  if (parameters_.analysis == Parameters::Analysis::dynamic) report.energy = e.total();
  return report;
}

void Structure::save(io::CheckpointWriter& file) const {
  const_cast<Structure*>(this)->visit(io::Archive(file));  // writing changes nothing
}

void Structure::load(io::CheckpointReader& file) {
  const ModalState fresh = initial_state();
  visit(io::Archive(file));
  for (const auto part :
       {&ModalState::q, &ModalState::v, &ModalState::a, &ModalState::q_old, &ModalState::v_old})
    if ((state_.*part).size() != (fresh.*part).size())
      throw Error("The checkpoint was written with a time scheme that differs from that of this run.");
  take_changed_energy(*oscillators_, parallel::comm_rank(context_.comm) == 0, state_);
  trial_ = state_;
  displacement_ = surface_.motion(state_.q);
}

void Structure::visit(io::Archive archive) {
  std::vector<double> omega = surface_.omega();
  archive.common("omega", omega);
  if (omega != surface_.omega())
    throw Error(
        "The checkpoint was written with modes that differ from those of this run: mesh, material, thickness, supports or the "
        "number of modes differ.");
  archive.common("state", state_);
}

void Structure::write_output(double time, int) { results_->write_fields(time); }
void Structure::write_monitors(double time) { results_->write_series(time); }
std::vector<std::string> Structure::finish() {
  results_->log();
  if (parameters_.analysis != Parameters::Analysis::modal) return {};
  std::vector<std::string> planes;
  for (const auto& [name, edge] : parameters_.boundaries)
    if (edge.support == Support::symmetry) planes.push_back(name);
  if (planes.empty()) return {};
  return {modes::missing_by_symmetry(planes, "'type: simply-supported'")};
}

}  // namespace couplet::plate
