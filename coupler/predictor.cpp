// SPDX-License-Identifier: Apache-2.0
#include "coupler/predictor.hpp"

namespace couplet {

InterfaceState predict(const InterfaceHistory& history, double dt, int order) {
  InterfaceState guess = history.now;
  if (order == 0) return guess;
  const bool two_levels = order == 2 && !history.old_velocity.empty();
  const double r = two_levels ? dt / history.old_dt : 0;
  for (std::size_t i = 0; i < guess.displacement.size(); ++i) {
    const double v = history.now.velocity[i];
    const double change = two_levels ? v - history.old_velocity[i] : 0;
    guess.displacement[i] += dt * (v + r / 2 * change);
    guess.velocity[i] += r * change;
  }
  return guess;
}

}  // namespace couplet
