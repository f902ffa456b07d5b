// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <string>
#include <vector>

#include "solid_solver/output/quantities.hpp"
#include "solid_solver/thermal/heat.hpp"

namespace couplet::solid {

/// Throws Error for a place or patch that the mesh does not have, and for conductivities that vary. Collective.
void check_heat_quantities(const Heat& heat, const std::map<std::string, SolidQuantity>& quantities);

/// Temperatures at places and heat through patches of a steady field, each with what its mesh leaves in it (weighted_defect() in the source): one
/// more solve with the same matrix for each. A temperature also has what the mean of vertices misses at its place, with the same sign. The same on all
/// ranks. Throws SolveFailure. Collective.
std::vector<QuantityEstimate> estimate_heat_quantities(
    const Heat& heat, const std::map<std::string, SolidQuantity>& quantities);

}  // namespace couplet::solid
