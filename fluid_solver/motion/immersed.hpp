// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "common/fv/expression.hpp"
#include "fluid_solver/parameters/parameters.hpp"
#include "fluid_solver/state/state.hpp"

namespace couplet::fluid {

/// Rigid bodies inside the mesh (direct forcing): the cells whose centre lies in a body carry its velocity,
/// no face of theirs lets anything through but what the body displaces, and the velocity in the layer of them
/// next to the fluid is set so that on the straight line to a fluid cell it passes through the body's
/// velocity where the level is zero. Cells change between body and fluid as the bodies move.
template <int D>
class ImmersedBodies {
 public:
  ImmersedBodies(const mesh::Mesh& mesh, const FluidParameters& parameters);

  /// Marks the cells at time t. Gives whether any mark changed on any rank. Collective.
  bool mark(double t, const Placement<D>& at);
  /// Part of a body since the last mark().
  bool is_solid(Index cell) const { return body_[cell] >= 0; }
  /// Nothing passes this flux face but what the body displaces.
  bool blocked(Index f) const {
    return is_solid(mesh_.owner[f]) || (f < mesh_.n_interior && is_solid(mesh_.neighbour[f]));
  }
  /// Volume flux of the bodies' motion through a blocked face [m^3/s].
  double flux(Index f, const Placement<D>& at) const;
  /// Sets u in the marked cells. Ghosts current before and after. Collective.
  void force(const Placement<D>& at, Vectors<D>& u) const;

  /// On each body, from the fluid cells at its faces [N]: pressure, then friction. Collective.
  std::vector<std::pair<Vec<D>, Vec<D>>> forces(const Placement<D>& at, const std::vector<double>& p,
                                                const Vectors<D>& u, double viscosity) const;
  const std::vector<std::string>& names() const { return names_; }
  /// Sum of |phi - what the body displaces| over the faces between body and fluid [m^3/s]. Collective.
  double leak(const Placement<D>& at, const std::vector<double>& phi) const;

 private:
  Vec<D> velocity_of(Index solid_cell) const { return velocity_[solid_cell]; }
  const mesh::Mesh& mesh_;
  std::vector<std::string> names_;
  std::vector<fv::Expression> level_;
  std::vector<std::vector<fv::Expression>> speed_;
  std::vector<int> body_;      // per local cell; -1: fluid
  std::vector<double> depth_;  // per local cell: lowest level of all bodies [m]
  Vectors<D> velocity_;        // per local cell, of its body
  std::vector<Index> faces_;   // interior faces between body and fluid
};

}  // namespace couplet::fluid
