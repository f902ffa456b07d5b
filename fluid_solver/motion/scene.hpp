// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "fluid_solver/boundary/boundary.hpp"
#include "fluid_solver/motion/obstacles.hpp"
#include "fluid_solver/motion/rotating_frame.hpp"
#include "fluid_solver/state/fourth_order.hpp"

namespace couplet::fluid {

/// Everything that stays the same in all steps of a run.
template <int D>
struct Scene {
  const mesh::Mesh& mesh;
  const std::vector<Vec3>& points_at_rest;  ///< as read, per local point [m]
  const Boundary<D>& boundary;
  const FluidParameters& parameters;
  Properties fluid;
  bool oblique = false;                      ///< the non-orthogonal parts are needed
  std::optional<RotatingFrame<D>> frame{};   ///< empty if there is none
  std::unique_ptr<FourthOrder<D>> fourth{};  ///< nullptr: second order everywhere
  /// Each step marks their cells.
  std::unique_ptr<Obstacles<D>> obstacles = std::make_unique<Obstacles<D>>(mesh);

  /// The placement as the pressure equation sees it.
  const Placement<D>& around(const Step<D>& step) const {
    return obstacles->around() ? *obstacles->around() : *step.to;
  }
  const std::vector<Vec3>& points_of(const Step<D>& step) const {
    return step.points.empty() ? points_at_rest : step.points;
  }
  /// Velocity whose means at the faces are the fluxes of u. Collective.
  const Vectors<D>& flux_velocity(const Placement<D>& at, const Vectors<D>& u) const {
    return fourth ? fourth->flux_velocity(at, u) : u;
  }
  bool is_compressible() const { return fluid.sound > 0; }
};

}  // namespace couplet::fluid
