// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "solid_solver/body/solid_body.hpp"
#include "solid_solver/equilibrium/equilibrium.hpp"

namespace couplet::solid {

/// Relative error of a static large-strain displacement along its softest motion x. A mesh that is too stiff
/// by dK leaves a = x . dK u / x . K x of x in u, with the tangent K. Near the loss of stability this far
/// exceeds the share of strain energy. dK is the difference of two gradients, or of face strains and their
/// mean (InnerVariation), in Green's strain of u and of x about it. 0 if no stable motion is known.
/// `unknowns`, `known`: unknowns and known values of u. Collective.
double soft_mesh_error(const SolidBody& body, std::span<const double> unknowns, std::span<const double> known,
                       const SoftMotion& softest);

}  // namespace couplet::solid
