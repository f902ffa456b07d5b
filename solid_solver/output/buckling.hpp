// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "common/elasticity/finite/stress_stiffness.hpp"
#include "common/modes/pencil.hpp"
#include "solid_solver/body/solid_fields.hpp"

namespace couplet::solid {

/// Prestress of the linear solution in `fields` with the tangent of the loads at `time`. Pressures follow the
/// surface, and they and body forces are those of the place to which the body moves. A body force without
/// potential (b_y = f(x)) belongs to the body, and tractions and forces keep their direction. Collective.
elastic::Prestress prestress_of(const SolidBody& body, const SolidFields& fields, double time);

/// Largest compression in it [Pa], at least 0. Collective.
double compression(const mesh::Mesh& mesh, const elastic::Prestress& prestress);

/// (K + lambda K_sigma) x = 0: lambda times the loads make the linear equilibrium neutral.
struct Buckling {
  std::vector<double> factor;  ///< lambda above 0, ascending; empty if these loads cause no buckling
  std::vector<std::vector<double>> shape;  ///< x on the rows of ElasticOperator, largest component 1
};

/// Finds the lowest `n` factors, or all if fewer. Counting negative pivots of K + s K_sigma, s above the
/// last, ensures that none is missed. `body`: static, symmetric gradient. Throws SolveFailure. Collective.
Buckling find_buckling(const SolidBody& body, const elastic::Prestress& prestress, int n);

/// Lowest n free vibrations about the loaded equilibrium, (K + K_sigma) x = omega^2 M x. Sets the density of
/// the kernel. Throws SolveFailure, also for an unstable equilibrium. Collective.
modes::EigenModes preloaded_modes(const SolidBody& body, const elastic::Prestress& prestress, int n);

}  // namespace couplet::solid
