// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "solid_solver/body/solid_body.hpp"
#include "solid_solver/equilibrium/equilibrium.hpp"

namespace couplet::solid {

/// Relative mesh error of the displacement u of a linear static body with thermal strains, where the work of
/// the loads is no measure: expansion stores far more energy than bending. Missed strains are weighted
/// by the dual solution, K z = V u, of J = integral of u^2/2 (dual weighted residuals, [becker2001]):
///   [ sum_f V_f |2 mu dE_f(u) : dE_f(z)| + 1/3 |sum_P sum_f V_fP (s_f - s_P) : (E_f - E_P)(z)| ] / integral of u^2
/// The integral of u^2 under it is at least sqrt(integral of u^2 integral of v^2), with the displacement v about its
/// center of the body that heat would free: heat may strain a held body little. dE is the strain difference of two face gradients, s the stress without its thermal part, s_P and E_P cell
/// means. The second sum follows InnerVariation for all cells and gradients. `pressure`: thermal [Pa], per
/// local face. Uses a method made for one solve; NaN if it fails. Collective.
double weighted_mesh_error(const SolidBody& body, std::span<const double> unknowns,
                           std::span<const double> known, std::span<const double> pressure);

/// Relative error of a static large-strain displacement along its softest motion x. A mesh that is too stiff
/// by dK leaves a = x . dK u / x . K x of x in u, with the tangent K. Near the loss of stability this far
/// exceeds the share of strain energy. dK is the difference of two gradients, or of face strains and their
/// mean (InnerVariation), in Green's strain of u and of x about it. 0 if no stable motion is known.
/// `unknowns`, `known`: of u. Collective.
double soft_mesh_error(const SolidBody& body, std::span<const double> unknowns, std::span<const double> known,
                       const SoftMotion& softest);

}  // namespace couplet::solid
