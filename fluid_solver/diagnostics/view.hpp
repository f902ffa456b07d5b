// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "common/coupling/participant.hpp"
#include "common/diagnostics/diagnostics.hpp"
#include "fluid_solver/step/fluid.hpp"

namespace couplet::fluid {

/// State of a fluid run after the last accepted step, as diagnostics see it.
template <int D>
struct FluidView {
  const mesh::Mesh& mesh;
  const Fluid<D>& fluid;
  SubStepSize<D>& sizes;       ///< limits of the step; caches its results
  const coupling::Step& step;  ///< the accepted one
  bool has_interface;          ///< a structure moves some walls
  bool has_mover;              ///< a mesh mover moves the mesh
  bool is_prescribed;          ///< the case moves the mesh
  /// Largest displacement of an interface on a mesh at rest, relative to the cell height there.
  const double& wall_displacement;
  const int& renewals;         ///< repeated predictions in the last step
  const double& unseen_share;  ///< error of the friction at the end of the last step, over the load

  const FluidParameters& parameters() const { return fluid.parameters(); }
  int rank() const { return parallel::comm_rank(mesh.comm); }
  bool stands_still() const {
    return has_interface && !has_mover && step.scheme != coupling::Scheme::standalone;
  }
};

/// Faces of walls that move in their normal direction.
template <int D>
std::vector<Index> moving_faces(const FluidView<D>& view);

// Quantities used by several diagnostics. Collective.
template <int D>
double largest_speed(const FluidView<D>& view);  ///< [m/s]
/// Largest minus smallest pressure [Pa]. Empty in the first step, whose pressure is an impulse.
template <int D>
std::optional<double> pressure_range(const FluidView<D>& view);

/// Adds all diagnostics of a fluid.
template <int D>
void add_diagnostics(const FluidView<D>& view, diagnostics::Diagnostics& all);

}  // namespace couplet::fluid
