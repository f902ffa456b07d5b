// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "solid_solver/body/solid_body.hpp"
#include "solid_solver/equilibrium/equilibrium.hpp"

namespace couplet::solid {

/// How far the displacement of a static run at large strain errs along its softest motion x, over its size. A mesh that is too stiff by dK
/// leaves a = x . dK u / x . K x of x in u, K being the tangent: near the loss of stability far more than its share of the strain
/// energy, which a load along a column may hardly be. dK by what the two gradients, or the faces' strains and their mean
/// (InnerVariation), make of Green's strain of u and of that of x about it. 0: no such motion is known, or no stable one.
/// `unknowns`, `known`: of u. Collective.
double soft_mesh_error(const SolidBody& body, std::span<const double> unknowns, std::span<const double> known,
                       const SoftMotion& softest);

}  // namespace couplet::solid
