// SPDX-License-Identifier: Apache-2.0
#include "plate_modal/structure.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <utility>

#include "common/base/error.hpp"
#include "common/log/log.hpp"
#include "common/mesh/on_root.hpp"
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

double largest_of(const std::vector<double>& vectors) {
  double largest = 0;
  for (std::size_t i = 0; i < vectors.size(); i += 3) largest = std::max(largest, Vec3(&vectors[i]).norm());
  return largest;
}

double norm_of(std::span<const double> amplitudes) {
  return std::sqrt(std::inner_product(amplitudes.begin(), amplitudes.end(), amplitudes.begin(), 0.0));
}

/// Rate at which damping `c` takes away what moves as the modes do now [1/s].
double rate_of_decay(std::span<const double> omega, std::span<const double> c, std::span<const double> v) {
  double lost = 0, all = 0;
  for (std::size_t m = 0; m < c.size(); ++m) {
    // The slower of two rates beyond the critical damping.
    lost += v[m] * v[m] * (c[m] <= 2 * omega[m] ? 0.5 * c[m] : omega[m] * omega[m] / c[m]);
    all += v[m] * v[m];
  }
  return all > 0 ? lost / all : 0;
}

/// Kinetic, strain and contact energy without what the scheme made, or the work of the loads: whichever is more.
double true_energy(const ModalState& state) {
  const Energies& e = state.energies;
  return std::max(e.kinetic + e.strain + e.contact - std::max(0.0, e.mismatch()), std::abs(e.load_work));
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
  if (p.analysis == Parameters::Analysis::dynamic)
    resolution_ = std::make_unique<Resolution>(share_->omega());
  oscillators_ =
      std::make_unique<Oscillators>(share_->omega(), damping(), gravity_, p.time_scheme, contact_.get());
  state_ = trial_ = initial_state();
  if (contact_ && !p.contact->starts_inside) refuse_wound_springs();
  results_ = std::make_unique<PlateResults>(*this);
  find_rotations();
  mesh::on_root(context_.comm, [&] {
    if (built_.plate && resolution_)
      truncation_ = std::make_unique<Truncation>(*built_.plate, built_.model, p.placement.normal());
  });
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
  const double made = trial_.energies.mismatch(), had = std::max(largest_true_, true_energy(trial_));
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
  if (truncation_) take_fluid(in);
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
  trial_largest_ = largest_of(direct_.empty() ? u : direct_);
  out["displacement"] = std::move(u);
  out["velocity"] = std::move(v);
  if (parameters_.surface_density) out["surface-density"] = built_.model.face_density;
  return out;
}

void Structure::add_pressure(double t, std::span<double> load) {
  pressure_->at(t, load);
  load_acted_ = load_acted_ || std::ranges::any_of(load, [](double f) { return f != 0; });
}

/// Does the step that is accepted now (from trial_, before, to state_) resolve what it moves?
void Structure::look_at_step() {
  resolution_->accepted(trial_, state_, oscillators_->load(), step_.dt);
  // A load that differs from place to place costs an expression a face: not each time.
  const long steps = resolution_->steps();
  if (pressure_ && pressure_->changes_in_time() &&
      (pressure_->is_uniform() || steps <= 16 || steps % 16 == 0))
    resolution_->load(pressure_->seen(step_.time, step_.dt, 6 + int(steps % 5)));
  const double work = state_.energies.impact_work - trial_.energies.impact_work;
  if (contact_ && work != 0)
    resolution_->impact(contact_->stiffness_of_impact(trial_.q, state_.q, oscillators_->seat().force), work,
                        std::max(largest_exchange_, state_.energies.kinetic + state_.energies.strain),
                        step_.dt);
}

coupling::StepReport Structure::accept_step() {
  std::swap(state_, trial_);
  met_seat_ = met_seat_ || state_.energies.impact_work != 0;
  if (step_errors_ && resolution_)  // trial_ is what it started from
    step_errors_->add(trial_.v, state_.v, state_.dt, trial_.dt, norm_of(state_.q), norm_of,
                      parameters_.damping ? rate_of_decay(share_->omega(), damping(), state_.v) : 0);
  if (resolution_) look_at_step();
  largest_ = std::max(largest_, trial_largest_);
  if (!rotations_.empty()) look_at_rotation();
  if (resolution_) look_at_modes();
  const Energies& e = state_.energies;
  worst_mismatch_ = std::max(worst_mismatch_, std::abs(e.mismatch()));
  largest_true_ = std::max(largest_true_, true_energy(state_));
  largest_exchange_ = std::max({largest_exchange_, e.kinetic + e.strain + e.contact, std::abs(e.load_work)});
  return {.dt = step_.dt, .iterations = oscillators_->newton_iterations(), .energy = e.total()};
}

std::vector<double> Structure::displacement() const {
  if (!direct_.empty()) return direct_;
  return share_->gather_vertices(state_.q);
}

void Structure::write_output(double time, int) { results_->write_fields(time); }
void Structure::write_monitors(double time) { results_->write_series(time); }

std::vector<std::string> Structure::finish() {
  finished_ = true;
  std::vector<std::string> said;
  if (contact_ && !met_seat_)
    if (const Contact::Place nearest = contact_->deepest(state_.q); !(nearest.depth > 0))
      said.push_back(fmt::format(
          "contact: the structure never touched the seat; final minimum gap {:.3g} m, at ({:.4g}, {:.4g}, "
          "{:.4g}).",
          -nearest.depth, nearest.centre.x(), nearest.centre.y(), nearest.centre.z()));
  if (parameters_.analysis == Parameters::Analysis::dynamic && largest_exchange_ > 0)
    said.push_back(fmt::format(
        "energy: max error of the balance of the structure (4.29-4.31): {:.2e} J, {:.2g} % of the largest "
        "energy.",
        worst_mismatch_, 100 * worst_mismatch_ / largest_exchange_));
  return said;
}

}  // namespace couplet::plate
