// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "common/diagnostics/effects.hpp"
#include "common/mesh/gmsh/gmsh.hpp"
#include "fluid_solver/parameters/parameters.hpp"

namespace couplet::fluid {

/// Scene that the cards look at: the parameters, and what the job around the fluid decides.
struct FluidScene {
  FluidParameters parameters;
  bool moving_mesh = false;  ///< the job has a mesh mover
  bool coupled = false;
};

using FluidCard = diagnostics::EffectCard<FluidScene>;
std::span<const FluidCard> fluid_effect_cards();

/// `effects: auto` of a fluid: its dimension, laminar or large-eddy, how the viscous term is stepped, whether pressure waves are
/// computed, and whether the mesh moves.
/// The speed is the largest that boundaries, profiles and the start name; the Reynolds number stands on the smallest side of
/// the mesh's box.
std::vector<diagnostics::EffectChoice> choose_effects(const FluidParameters& parameters,
                                                      const mesh::MeshFacts& mesh,
                                                      const diagnostics::CaseScene& scene);

/// Estimates the cost from configs/cavity and taylor-green-3d on one rank.
diagnostics::ExpectedCost expected_cost(const FluidParameters& parameters, const mesh::MeshFacts& mesh);

}  // namespace couplet::fluid
