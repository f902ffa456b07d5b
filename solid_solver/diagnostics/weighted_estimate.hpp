// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "solid_solver/body/solid_body.hpp"
#include "solid_solver/equilibrium/equilibrium.hpp"

namespace couplet::solid {

/// What the mesh leaves in the displacement u of a linear static body, over the size of u, where the work of the loads is no measure
/// of it: heat expands a body everywhere, with far more energy than that by which it bends it. How J = integral of u^2 / 2 answers to
/// forces, K z = V u, weighs what the strains miss (dual weighted residuals, [becker2001]):
///   [ sum_f V_f |2 mu dE_f(u) : dE_f(z)| + 1/3 sum_P |sum_f V_fP (s_f - s_P) : (E_f - E_P)(z)| ] / integral of u^2
/// with dE the difference of two face gradients' strains, s the stress of u less that of the thermal strain, s_P and E_P the means of
/// a cell (a third of the variation: see InnerVariation, here of all kinds of cells and gradients). `pressure` [Pa]: of the thermal
/// strain, one a local face. A method made for one solve; NaN: it failed. Collective.
double weighted_mesh_error(const SolidBody& body, std::span<const double> unknowns,
                           std::span<const double> known, std::span<const double> pressure);

/// How far the displacement of a static run at large strain errs along its softest motion x, over its size. A mesh that is too stiff by dK
/// leaves a = x . dK u / x . K x of x in u, K being the tangent: near the loss of stability far more than its share of the strain
/// energy, which a load along a column may hardly be. dK by what the two gradients, or the faces' strains and their mean
/// (InnerVariation), make of Green's strain of u and of that of x about it. 0: no such motion is known, or no stable one.
/// `unknowns`, `known`: of u. Collective.
double soft_mesh_error(const SolidBody& body, std::span<const double> unknowns, std::span<const double> known,
                       const SoftMotion& softest);

}  // namespace couplet::solid
