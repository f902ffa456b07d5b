// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <span>

#include "fluid_solver/state/placement.hpp"

namespace couplet::fluid {

/// Divided differences of u in time. Where nothing drives: rate and its change become those of this step, u is kept.
template <int D>
struct Differences {
  std::span<const double> volume;
  const Vec<D>* now;
  Vec<D>*u, *rate, *change;
  double per_step, per_apart;  ///< per_apart 0: there is no rate yet
};
/// Sums over the volume of the squares of u, its rate, the change of that and the change of that, and the volume.
std::array<double, 5> renew(const Differences<2>& d);
std::array<double, 5> renew(const Differences<3>& d);

}  // namespace couplet::fluid
