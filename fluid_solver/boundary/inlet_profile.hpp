// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "fluid_solver/parameters/parameters.hpp"
#include "fluid_solver/state/placement.hpp"

namespace couplet::fluid {

/// Speed at the faces of an inlet relative to its mean.
template <int D>
struct InletShape {
  Vec<D> direction = Vec<D>::Zero();  ///< unit vector into the domain
  std::vector<double> speed;          ///< per face of the patch; its mean over the area is 1 to round-off
};

/// Parabolic: 4 s (1 - s) between the two ends of a line (2-D), 1 - (r/R)^2 on a disc (3-D), scaled to the
/// mean. Throws Error if the patch is no straight line or no disc. Collective.
template <int D>
InletShape<D> inlet_shape(const mesh::Mesh& mesh, const mesh::Geometry& geometry, const mesh::Patch& patch,
                          InletProfile profile);

}  // namespace couplet::fluid
