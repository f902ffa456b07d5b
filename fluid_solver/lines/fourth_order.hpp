// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <utility>

#include "fluid_solver/lines/lines.hpp"
#include "fluid_solver/state/state.hpp"

namespace couplet::fluid {

/// What the links of lines add to the operators of second order (docs/theory.md, 2 "Fourth order"); D the second difference of
/// a link, U its flux velocity times S.
template <int D>
class FourthOrder {
 public:
  FourthOrder(const mesh::Mesh& mesh, Lines<D> lines) : mesh_(mesh), lines_(std::move(lines)) {}

  /// Adds to the rate of convection and friction (nu = 0: without) of a state. Collective.
  void add_rates(const State<D>& state, double nu, Vectors<D>& rate) const;
  /// u - n (n.Du)/6 over the links of each cell, ghosts current: its means are the fluxes of fourth order. Collective.
  const Vectors<D>& flux_velocity(const Placement<D>& at, const Vectors<D>& u);
  /// The transpose of it, on a gradient of the pressure: g - n (n.D(V g))/(6 V). Collective.
  void sharpen(const Placement<D>& at, Vectors<D>& gradient) const;
  /// mu sum (g_1 x - g_2 y)^2/(g_1 + g_2)/6, the part of friction in what the flow loses, of this rank [W].
  double dissipation(double mu, const Vectors<D>& u) const;
  double share() const { return lines_.share; }

 private:
  const mesh::Mesh& mesh_;
  Lines<D> lines_;
  Vectors<D> flux_velocity_;
};

}  // namespace couplet::fluid
