// SPDX-License-Identifier: Apache-2.0
#include "plate_modal/structure.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "common/base/error.hpp"
#include "common/io/checkpoint.hpp"
#include "common/log/log.hpp"
#include "common/mesh/on_root.hpp"
#include "plate_modal/effect_cards.hpp"
#include "plate_modal/results.hpp"

namespace couplet::plate {
namespace {

/// A side of the plate: faces whose normal is within 60 degrees of that of the plate.
constexpr double least_cosine = 0.5;

/// Thickness over half the length of a bending wave of this frequency in the thickest part of a plate:
/// D k^4 = rho h omega^2.
double thickness_over_wave(const Parameters& p, double omega) {
  double largest = 0;
  const auto of = [&](double h, double density, double youngs_modulus) {
    const double d =
        youngs_modulus * h * h * h / (12 * (1 - p.material.poissons_ratio * p.material.poissons_ratio));
    largest = std::max(largest, h * std::pow(density * h * omega * omega / d, 0.25) / std::numbers::pi);
  };
  of(p.thickness, p.material.density, p.material.youngs_modulus);
  for (const auto& [name, zone] : p.zones)
    of(zone.thickness.value_or(p.thickness), zone.density.value_or(p.material.density),
       zone.youngs_modulus.value_or(p.material.youngs_modulus));
  return largest;
}

}  // namespace

Structure::Structure(Parameters parameters, PlateContext context, const RawMesh* raw)
    : parameters_(std::move(parameters)),
      context_(std::move(context)),
      built_(build_model(parameters_, context_, raw)),
      share_(std::make_unique<Share>(context_.comm, built_.model)) {
  const Parameters& p = parameters_;
  if (comm_rank(context_.comm) == 0) {
    if (!built_.note.empty()) log::warn("{}", built_.note);
    if (built_.reused)
      log::info("modes of {} are used again", (context_.output_folder / "modes.h5").string());
  }
  if (p.analysis == Parameters::Analysis::static_ && share_->omega().front() == 0)
    throw Error(
        "The structure moves as a rigid body (mode 1 has no frequency): a static analysis needs supports "
        "that hold "
        "it.");
  gravity_.assign(share_->n_modes(), 0);
  if (!p.gravity.empty()) gravity_ = share_->participation(Vec3(p.gravity.data()));
  if (p.contact)
    contact_ = std::make_unique<Contact>(*share_, *p.contact, p.placement.normal(),
                                         p.contact->stiffness ? 0 : seat_stiffness(p));
  if (p.load && p.load->upper) upper_.emplace(*p.load->upper, "load.upper-pressure");
  if (p.load && p.load->lower) lower_.emplace(*p.load->lower, "load.lower-pressure");
  oscillators_ =
      std::make_unique<Oscillators>(share_->omega(), damping(), gravity_, p.time_scheme, contact_.get());
  state_ = trial_ = initial_state();
  results_ = std::make_unique<PlateResults>(*this);
}

Structure::~Structure() = default;

std::vector<double> Structure::damping() const {
  const Damping d = parameters_.damping.value_or(Damping{});
  std::vector<double> c;
  for (const double omega : share_->omega())
    c.push_back(2 * d.ratio * omega + d.mass + d.stiffness * omega * omega);
  return c;
}

ModalState Structure::initial_state() const {
  std::vector<double> q(share_->n_modes(), 0), v = share_->participation(parameters_.initial_velocity);
  std::vector<double> largest(q.size(), 1);
  if (std::ssize(parameters_.initial_amplitudes) > std::ssize(q))
    throw Error("initial-amplitudes: {} are given for {} modes.", parameters_.initial_amplitudes.size(),
                q.size());
  if (comm_rank(context_.comm) == 0)
    for (std::size_t m = 0; m < q.size(); ++m) largest[m] = largest_displacement(built_.model, m);
  broadcast(context_.comm, largest);
  for (std::size_t m = 0; m < parameters_.initial_amplitudes.size(); ++m)
    q[m] = parameters_.initial_amplitudes[m] / largest[m];
  return oscillators_->start(std::move(q), std::move(v));
}

Interface Structure::initialise() {
  Interface interface = share_->describe();
  interface.takes = {{"pressure-force", "N", Interface::Place::faces},
                     {"viscous-force", "N", Interface::Place::faces}};
  interface.gives = {{"displacement", "m", Interface::Place::vertices},
                     {"velocity", "m/s", Interface::Place::vertices}};
  if (parameters_.surface_density)
    interface.gives.push_back({"surface-density", "kg/m^2", Interface::Place::faces, 1});
  results_->write_start();
  return interface;
}

void Structure::add_pressure(double t, std::span<double> load) const {
  const Vec3 normal = parameters_.placement.normal();
  std::vector<double> force(3 * share_->n_faces(), 0);
  for (std::size_t f = 0; f < share_->n_faces(); ++f) {
    const Vec3& area = share_->areas()[f];
    const double cosine = area.dot(normal) / area.norm();
    const auto& side = cosine > least_cosine ? upper_ : lower_;
    if (!side || std::abs(cosine) <= least_cosine) continue;
    const double pressure = (*side)(share_->centres()[f], t);
    for (int c = 0; c < 3; ++c) force[3 * f + c] = -pressure * area[c];
  }
  share_->add_load(force, load);
}

/// Kinetic, strain and contact energy without what the scheme made, or the work of the loads: whichever is more.
double Structure::true_energy(const ModalState& state) const {
  const Energies& e = state.energies;
  return std::max(e.kinetic + e.strain + e.contact - std::max(0.0, e.mismatch()), std::abs(e.load_work));
}

/// A scheme that has made more energy than the structure ever had moves something else than the structure.
void Structure::refuse_made_energy() const {
  const double made = trial_.energies.mismatch(), had = std::max(largest_true_, true_energy(trial_));
  if (!(made > had)) return;
  throw SolveFailure(
      "At t = {:g} s the time scheme has made {:.3g} J, more than the {:.3g} J that the structure had at most: the "
      "motion is the scheme's, not the structure's. Take {}.",
      step_.time + step_.dt, made, had,
      parameters_.contact && parameters_.contact->rule == ContactRule::midpoint
          ? "'contact.rule: conserving', or 'simulation.time-step' below a twentieth of a contact"
          : "a smaller 'simulation.time-step'");
}

Exchange Structure::solve(const Exchange& in) {
  std::vector<double> fluid(share_->n_modes(), 0);
  for (const char* name : {"pressure-force", "viscous-force"}) {
    const auto given = in.find(name);
    share_->add_load(share_->scatter_faces(given == in.end() ? std::vector<double>{} : given->second), fluid);
  }
  share_->sum(fluid);
  if (parameters_.analysis == Parameters::Analysis::dynamic) {
    const auto load = [&](double after, std::span<double> total) {
      std::ranges::fill(total, 0);
      if (upper_ || lower_) {
        add_pressure(step_.time + after, total);
        share_->sum(total);
      }
      for (std::size_t m = 0; m < fluid.size(); ++m) total[m] += fluid[m];
    };
    oscillators_->step(state_, step_.dt, load, trial_);
    refuse_made_energy();
  } else if (parameters_.analysis == Parameters::Analysis::static_) {
    solve_static(step_.time + step_.dt, fluid);
  }
  Exchange out;
  std::vector<double> u = share_->gather_vertices(trial_.q), v = share_->gather_vertices(trial_.v);
  if (comm_rank(context_.comm) != 0) return out;
  trial_largest_ = 0;
  for (std::size_t i = 0; i < u.size(); i += 3) trial_largest_ = std::max(trial_largest_, Vec3(&u[i]).norm());
  out["displacement"] = std::move(u);
  out["velocity"] = std::move(v);
  if (parameters_.surface_density) out["surface-density"] = built_.model.face_density;
  return out;
}

StepReport Structure::accept_step() {
  std::swap(state_, trial_);
  largest_ = std::max(largest_, trial_largest_);
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

std::vector<EffectVerdict> Structure::audit() const {
  // What rank 0 knows of the whole surface decides on all ranks alike.
  std::vector<double> seen(3, PlateEvidence::unknown);
  if (comm_rank(context_.comm) == 0) {
    double size = 0;
    for (const Vec3& x : built_.model.vertices)
      size = std::max(size, (x - built_.model.vertices.front()).norm());
    // A body that moves as a whole may go far.
    if (share_->omega().front() > 0) seen[0] = largest_ / size;
    if (built_.held_all_round) seen[1] = largest_ / parameters_.thickness;
    if (parameters_.mesh) seen[2] = thickness_over_wave(parameters_, share_->omega().back());
  }
  broadcast(context_.comm, seen);
  PlateEvidence evidence{seen[0], seen[1], seen[2], PlateEvidence::unknown};
  if (parameters_.analysis == Parameters::Analysis::dynamic && largest_exchange_ > 0)
    evidence.energy_mismatch = worst_mismatch_ / largest_exchange_;
  return couplet::audit(plate_effect_cards(), PlateScene{parameters_}, evidence);
}

std::vector<std::string> Structure::finish() {
  if (parameters_.analysis != Parameters::Analysis::dynamic || !(largest_exchange_ > 0)) return {};
  return {
      fmt::format("energy: the balance of the structure (4.29-4.31) is off by at most {:.2e} J, {:.2g} % of "
                  "the largest energy.",
                  worst_mismatch_, 100 * worst_mismatch_ / largest_exchange_)};
}

void Structure::save(CheckpointWriter& file) const {
  file.write("omega", share_->omega());
  for (const auto& [name, values] : {std::pair{"q", &state_.q},
                                     {"v", &state_.v},
                                     {"a", &state_.a},
                                     {"q-old", &state_.q_old},
                                     {"v-old", &state_.v_old}})
    file.write(name, *values);
  const Energies& e = state_.energies;
  file.write("energies", std::vector<double>{e.kinetic, e.strain, e.gravity, e.contact, e.initial,
                                             e.load_work, e.impact_work, e.damping_loss, worst_mismatch_,
                                             largest_exchange_, largest_true_});
  file.write_scalar("dt", state_.dt);
}

void Structure::load(CheckpointReader& file) {
  if (file.read("omega") != share_->omega())
    throw Error(
        "The checkpoint was made with other modes than those of this run: mesh, material, thickness, "
        "supports or the "
        "number of modes differ.");
  state_ = initial_state();
  for (const auto& [name, values] : {std::pair{"q", &state_.q},
                                     {"v", &state_.v},
                                     {"a", &state_.a},
                                     {"q-old", &state_.q_old},
                                     {"v-old", &state_.v_old}})
    file.read(name, *values);
  std::vector<double> kept(11);
  file.read("energies", kept);
  Energies& e = state_.energies;
  int i = 0;
  for (double* part : {&e.kinetic, &e.strain, &e.gravity, &e.contact, &e.initial, &e.load_work,
                       &e.impact_work, &e.damping_loss, &worst_mismatch_, &largest_exchange_, &largest_true_})
    *part = kept[i++];
  state_.dt = file.read_scalar("dt");
  trial_ = state_;
}

}  // namespace couplet::plate
