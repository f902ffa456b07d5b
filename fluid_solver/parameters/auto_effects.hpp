// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "common/diagnostics/effects.hpp"
#include "common/mesh/gmsh/gmsh.hpp"
#include "fluid_solver/parameters/parameters.hpp"

namespace couplet::fluid {

/// `effects: auto` of a fluid: its dimension, laminar or large-eddy, how the viscous term is stepped, whether pressure waves are
/// computed, and whether the mesh moves.
/// The speed is the largest that boundaries, profiles and the start name; the Reynolds number stands on the smallest side of
/// the mesh's box.
std::vector<diagnostics::EffectChoice> choose_effects(const FluidParameters& parameters,
                                                      const mesh::MeshFacts& mesh,
                                                      const diagnostics::CaseScene& scene);

/// Decides whether pressure waves are computed: where sound takes longer across the mesh than 0.3/omega of what boundaries and
/// motions prescribe, where gaps shut off an inlet, and where an interface moves in a fluid without an outlet.
diagnostics::EffectChoice choose_waves(const FluidParameters& parameters, const mesh::MeshFacts& mesh,
                                       const diagnostics::CaseScene& scene);

/// Estimates the cost from configs/cavity and taylor-green-3d on one rank.
diagnostics::ExpectedCost expected_cost(const FluidParameters& parameters, const mesh::MeshFacts& mesh);

}  // namespace couplet::fluid
