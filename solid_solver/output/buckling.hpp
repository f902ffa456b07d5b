// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "common/elasticity/finite/stress_stiffness.hpp"
#include "common/modes/pencil.hpp"
#include "solid_solver/body/solid_fields.hpp"

namespace couplet::solid {

/// Of the linear solution that the fields hold, under the pressures at `time` (type: pressure), which follow the surface; tractions and
/// forces keep their direction. Collective.
elastic::Prestress prestress_of(const SolidBody& body, const SolidFields& fields, double time);

/// The largest compression in it [Pa], at least 0. Collective.
double compression(const mesh::Mesh& mesh, const elastic::Prestress& prestress);

/// (K + lambda K_sigma) x = 0: the given loads times lambda make the equilibrium of the linear theory neutral.
struct Buckling {
  std::vector<double> factor;              ///< lambda above 0, ascending; empty: these loads buckle nothing
  std::vector<std::vector<double>> shape;  ///< x on the rows of ElasticOperator, largest component 1
};

/// The lowest `n` (fewer if there are fewer). None is missed: the negative pivots of K + s K_sigma, s above the last, are counted.
/// `body`: static, with the symmetric gradient. Throws SolveFailure. Collective.
Buckling find_buckling(const SolidBody& body, const elastic::Prestress& prestress, int n);

/// The lowest n free vibrations about the loaded equilibrium, (K + K_sigma) x = omega^2 M x. Tells the kernel its density. Throws
/// SolveFailure, also where the equilibrium is not stable. Collective.
modes::EigenModes preloaded_modes(const SolidBody& body, const elastic::Prestress& prestress, int n);

}  // namespace couplet::solid
