// SPDX-License-Identifier: Apache-2.0
#include "fluid_solver/diagnostics/driving.hpp"

#include <algorithm>
#include <cmath>

#include "common/parallel/collective.hpp"

namespace couplet::fluid {

namespace {

constexpr int places_looked_at = 16, steps_looked_at = 16;
constexpr double still = 1e-6;  // of the largest value: a gust that has passed, a ramp that has ended

}  // namespace

Driving::Driving(const FluidParameters& parameters) {
  const auto add = [this](const config::ExpressionText& text) {
    if (fv::Expression found(text); found.uses_time()) timed_.push_back(std::move(found));
  };
  moves_ = parameters.motion || !parameters.gaps.empty();
  for (const auto& [name, body] : parameters.bodies) moves_ = moves_ || !body.velocity.empty();
  for (const auto& [patch, b] : parameters.boundaries) {
    const GivenBy by = condition_of(b).velocity;
    moves_ = moves_ || by == GivenBy::structure || by == GivenBy::motion;
  }
  for (const auto& [patch, b] : parameters.boundaries)
    if (condition_of(b).velocity == GivenBy::structure) return;
  for (const auto& [patch, b] : parameters.boundaries)
    by_mover_ = by_mover_ || (condition_of(b).velocity == GivenBy::motion && !parameters.motion);
  for (const auto& text : parameters.body_force) add(text);
  if (const auto& motion = parameters.motion) {
    for (const auto* texts : {&motion->translation, &motion->displacement})
      for (const auto& text : *texts) add(text);
    add(motion->angle);
  }
  for (const auto& [patch, b] : parameters.boundaries) {
    for (const auto& text : b.velocity) add(text);
    add(b.pressure);
  }
}

bool Driving::acts(MPI_Comm comm, std::span<const Vec3> places, double time, double dt,
                   std::span<const double> mesh_flux) const {
  const auto moves = [](double flux) { return flux != 0; };
  if (by_mover_ && parallel::any(comm, std::ranges::any_of(mesh_flux, moves))) return true;
  double change = 0;  // largest of the expressions, each over its own largest value
  const std::size_t stride = 1 + places.size() / places_looked_at;
  for (const fv::Expression& e : timed_) {
    double largest = 0, apart = 0;
    for (std::size_t i = 0; i < places.size(); i += stride) {
      const double now = e(places[i], time);
      largest = std::max(largest, std::abs(now));
      for (int k = 1; k <= steps_looked_at; ++k) {
        const double before = e(places[i], std::max(0., time - k * dt));
        largest = std::max(largest, std::abs(before));
        apart = std::max(apart, std::abs(now - before));
      }
    }
    largest = parallel::max(comm, largest), apart = parallel::max(comm, apart);
    if (largest > 0) change = std::max(change, apart / largest);
  }
  return change > still;
}

}  // namespace couplet::fluid
