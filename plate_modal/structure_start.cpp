// SPDX-License-Identifier: Apache-2.0
// Where the motion starts: seat, damping, amplitudes and velocities.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "common/base/error.hpp"
#include "common/log/log.hpp"
#include "common/mesh/on_root.hpp"
#include "plate_modal/structure.hpp"

namespace couplet::plate {

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

}  // namespace couplet::plate
