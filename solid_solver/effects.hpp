// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "common/diagnostics/effects.hpp"
#include "common/mesh/gmsh/gmsh.hpp"
#include "solid_solver/parameters/parameters.hpp"

namespace couplet::solid {

using SolidCard = diagnostics::EffectCard<SolidParameters>;
/// Tells whether a volume strain of the cells stands for that of the faces, so that nothing locks near incompressibility.
bool has_volume_strain_of_cells(const SolidParameters& parameters);
/// All that a solid can simulate beside linear elasticity, in the order in which it is told.
std::span<const SolidCard> solid_effect_cards();

/// `effects: auto` of a solid: its dimension, and whether inertia matters. The estimate of the latter is the
/// lowest period of a clamped bar of the mesh's box, T = 2 pi L^2/(3.516 h) sqrt(12 rho/E), beside the time in
/// which the loads change: an undamped oscillator under a ramp of length tau overshoots by up to T/(pi tau).
std::vector<diagnostics::EffectChoice> choose_effects(const SolidParameters& parameters,
                                                      const mesh::MeshFacts& mesh,
                                                      const diagnostics::CaseScene& scene);

/// By the numbers of configs/cantilever and cook on one rank.
diagnostics::ExpectedCost expected_cost(const SolidParameters& parameters, const mesh::MeshFacts& mesh);

}  // namespace couplet::solid
