// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "common/modes/pencil.hpp"
#include "solid_solver/stability/prestress.hpp"

namespace couplet::solid {

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
