// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <span>
#include <string>
#include <vector>

#include "common/diagnostics/effects.hpp"
#include "common/mesh/gmsh/gmsh.hpp"
#include "fluid_solver/parameters/parameters.hpp"

namespace couplet::fluid {

/// Input of the effect cards: the parameters, and the facts about the job around the fluid.
struct FluidScene {
  FluidParameters parameters;
  bool moving_mesh = false;  ///< the job has a mesh mover
  bool coupled = false;
};

using FluidCard = diagnostics::EffectEntry<FluidScene>;
std::span<const FluidCard> fluid_effect_cards();

/// A place of a patch at which its expressions are looked at. Velocities along the face carry no volume through it.
struct PlaceOfPatch {
  Vec3 at, normal = Vec3::Ones();
};
/// Places of a patch, or of the mesh for an empty name.
using PlacesOfPatch = std::function<std::vector<PlaceOfPatch>(const std::string&)>;
/// Largest rate of what boundaries and motions prescribe until the time `end` [1/s].
double prescribed_rate(const FluidParameters& parameters, const PlacesOfPatch& places_of, double end,
                       double step);

/// Resolves `effects: auto` of a fluid: its dimension, laminar flow or LES, the viscous scheme, pressure
/// waves, and mesh motion. The speed is the largest one in boundaries, profiles and the initial state. The
/// Reynolds number uses the smallest side of the mesh's bounding box.
std::vector<diagnostics::EffectChoice> choose_effects(const FluidParameters& parameters,
                                                      const mesh::MeshFacts& mesh,
                                                      const diagnostics::CaseScene& scene);

/// Estimates the cost from configs/cavity and taylor-green-3d on one rank.
diagnostics::ExpectedCost expected_cost(const FluidParameters& parameters, const mesh::MeshFacts& mesh);

}  // namespace couplet::fluid
