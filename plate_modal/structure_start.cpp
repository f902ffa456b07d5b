// SPDX-License-Identifier: Apache-2.0
// Where the motion starts: seat, damping, amplitudes and velocities, or a checkpoint.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "common/base/error.hpp"
#include "common/base/numbers.hpp"
#include "common/io/checkpoint.hpp"
#include "common/log/log.hpp"
#include "common/mesh/load.hpp"
#include "plate_modal/structure.hpp"

namespace couplet::plate {
namespace {

/// A restart with changes may have taken away the seat, or moved it, or the gravity: the energy that the structure has
/// in the new scene is where its balance starts from.
void take_changed_energy(const Oscillators& oscillators, bool tells, ModalState& state) {
  Energies& kept = state.energies;
  const Energies now = oscillators.start(state.q, state.v).energies;
  const double scale =
      std::abs(kept.kinetic) + std::abs(kept.strain) + std::abs(kept.gravity) + std::abs(kept.contact);
  const double jump = now.contact - kept.contact + now.gravity - kept.gravity;
  if (!(std::abs(now.contact - kept.contact) + std::abs(now.gravity - kept.gravity) > 1e-9 * scale)) return;
  if (tells)
    log::warn(
        "energy: with the changes of this restart the seat stores {:.4g} J instead of {:.4g} J, and gravity "
        "{:.4g} J instead of {:.4g} J: this jump of {:.4g} J is not part of the balance.",
        now.contact, kept.contact, now.gravity, kept.gravity, jump);
  kept.contact = now.contact;
  kept.gravity = now.gravity;
  kept.initial += jump;
}

}  // namespace

/// A seat in which the structure stands at the start has wound springs: energy that nobody asked for.
void Structure::refuse_wound_springs() const {
  double size = 0;
  for (const Vec3& x : share_->centres()) size = std::max(size, (x - share_->centres().front()).norm());
  const Contact::Place place = contact_->deepest(state_.q);
  if (place.depth <= 1e-9 * parallel::max(share_->comm(), size)) return;
  throw Error(
      "contact: initially the structure is {:.3g} m inside the seat, deepest at ({:g}, {:g}, {:g}). Lower "
      "'height' (it counts from the origin along the direction; a side of a plate is half a thickness from "
      "its mid-surface), or set 'starts-inside: true' if these springs are meant to push from the start.",
      place.depth, place.centre.x(), place.centre.y(), place.centre.z());
}

/// The seat, and what a step should be for it.
void Structure::make_contact() {
  const Parameters& p = parameters_;
  contact_ = std::make_unique<Contact>(*share_, *p.contact, p.placement.normal(),
                                       p.contact->stiffness ? 0 : seat_stiffness(p));
  const double shortest = std::numbers::pi / std::sqrt(contact_->largest_stiffness());
  if (parallel::comm_rank(context_.comm) != 0) return;
  const double steps = shortest / context_.time_step;
  const std::string text = fmt::format(
      "contact: over all faces it lasts {:.3g} s (pi sqrt(m / kappa)), over part of them longer", shortest);
  if (std::isnan(steps))
    log::info("{}.", text);
  else if (steps >= 10)
    log::info("{}: {:.3g} steps of it.", text, steps);
  else
    log::warn(
        "{}: {:.2g} steps of it. Twenty resolve the speed after it to 1 %: 'simulation.time-step: {:.2g} s'.",
        text, steps, shortest / 20);
}

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
  if (parallel::comm_rank(context_.comm) == 0)
    for (std::size_t m = 0; m < q.size(); ++m) largest[m] = modes::largest_displacement(built_.model, m);
  mesh::broadcast(context_.comm, largest);
  for (std::size_t m = 0; m < parameters_.initial_amplitudes.size(); ++m)
    q[m] = parameters_.initial_amplitudes[m] / largest[m];
  return oscillators_->start(std::move(q), std::move(v));
}

void Structure::save(io::CheckpointWriter& file) const {
  file.write_common("omega", share_->omega());
  file.write_common("state", base::to_numbers(state_));
}

void Structure::load(io::CheckpointReader& file) {
  if (file.read_common("omega") != share_->omega())
    throw Error(
        "The checkpoint was written with other modes than this run uses: mesh, material, thickness, "
        "supports or the number of modes differ.");
  const ModalState fresh = initial_state();
  base::from_numbers(file.read_common("state"), state_, "modes");
  for (const auto part :
       {&ModalState::q, &ModalState::v, &ModalState::a, &ModalState::q_old, &ModalState::v_old})
    if ((state_.*part).size() != (fresh.*part).size())
      throw Error("The checkpoint was written with another time scheme than this run uses.");
  take_changed_energy(*oscillators_, parallel::comm_rank(context_.comm) == 0, state_);
  trial_ = state_;
  displacement_ = share_->gather_vertices(state_.q);
}

}  // namespace couplet::plate
