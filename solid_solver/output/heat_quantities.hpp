// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <string>
#include <vector>

#include "solid_solver/output/quantities.hpp"
#include "solid_solver/thermal/heat.hpp"

namespace couplet::solid {

/// Throws Error for a missing place or patch and for varying conductivities. Collective.
void check_heat_quantities(const Heat& heat, const std::map<std::string, SolidQuantity>& quantities);

/// Temperatures at places and heat flows through patches of a steady field, with their mesh errors
/// (weighted_defect() in the source). Each needs one solve with the same matrix. A temperature adds the
/// signed interpolation error at its place. Equal on all ranks. Throws SolveFailure. Collective.
std::vector<QuantityEstimate> estimate_heat_quantities(
    const Heat& heat, const std::map<std::string, SolidQuantity>& quantities);

}  // namespace couplet::solid
