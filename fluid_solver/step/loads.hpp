// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "fluid_solver/motion/scene.hpp"

namespace couplet::fluid {

/// Forces on what is outside the fluid, per boundary face [N]: the momentum that the fluid's own equation lets through the wall,
/// +p_b S^{n+1/2} with the scheme's wall pressure and the whole viscous flux mu g (u_P - w) with its weights in time. A pressure
/// extrapolated from the cells and the tangential flux alone differ from it by a layer of the splitting, of first order in the step and
/// the mesh.
template <int D>
struct Loads {
  Vectors<D> pressure;  ///< and the normal part of the viscous flux
  Vectors<D> viscous;   ///< its tangential part

  /// Sets the forces of a step from a level, after its projection.
  void set(const Scene<D>& scene, const Step<D>& step, const Prediction<D>& prediction,
           const Projected<D>& projected, const State<D>& from);
};

}  // namespace couplet::fluid
