// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <utility>
#include <vector>

#include "fluid_solver/state/placement.hpp"
#include "fluid_solver/state/state.hpp"

namespace couplet::fluid {

/// Three cells in a row. The middle one is owned; its two faces are parallel and normal to the line of cells.
struct Link {
  Index before, cell, after;
  Index face;                        ///< one of the two, with S pointing from `before` to `after`
  int axis = -1;                     ///< axis parallel to S; -1 if there is none
  double g_before = 0, g_after = 0;  ///< conductances of the two faces [m]
};

/// Links of a mesh at rest, in the order of their cells.
template <int D>
struct Lines {
  std::vector<Link> links;
  double share = 0;  ///< fraction of links among the cells and directions of the whole mesh

  /// Collective.
  Lines(const mesh::Mesh& mesh, const Placement<D>& at);
  /// Placement for the fourth-order operators: the face value is the mean of two cells if both have a link
  /// across the face. Collective.
  std::shared_ptr<const Placement<D>> seen(const mesh::Mesh& mesh, const Placement<D>& at) const;
};

/// Corrections by links to the second-order operators (docs/theory/fluid-models.md). D is the second
/// difference of a link, U its flux velocity times S.
template <int D>
class FourthOrder {
 public:
  FourthOrder(const mesh::Mesh& mesh, Lines<D> lines) : mesh_(mesh), lines_(std::move(lines)) {}

  /// Adds to the rate of convection and friction (none if nu = 0) of a state. Collective.
  void add_rates(const State<D>& state, double nu, Vectors<D>& rate) const;
  /// u - n (n.Du)/6 over the links of each cell, ghosts current; its means are the fluxes. Collective.
  const Vectors<D>& flux_velocity(const Placement<D>& at, const Vectors<D>& u);
  /// Applies the transpose to a pressure gradient: g - n (n.D(V g))/(6 V). Collective.
  void sharpen(const Placement<D>& at, Vectors<D>& gradient) const;
  /// mu sum (g_1 x - g_2 y)^2/(g_1 + g_2)/6, the contribution to viscous dissipation on this rank [W].
  double dissipation(double mu, const Vectors<D>& u) const;
  double share() const { return lines_.share; }

 private:
  const mesh::Mesh& mesh_;
  Lines<D> lines_;
  Vectors<D> flux_velocity_;
};

}  // namespace couplet::fluid
