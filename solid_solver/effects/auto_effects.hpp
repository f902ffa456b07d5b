// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "common/diagnostics/effects.hpp"
#include "common/mesh/gmsh/gmsh.hpp"
#include "solid_solver/parameters/parameters.hpp"

namespace couplet::solid {

/// `effects: auto` of a solid: its dimension, and whether inertia matters. The estimate of the latter is the
/// lowest period of a clamped bar of the mesh's box, T = 2 pi L^2/(3.516 h) sqrt(12 rho/E), beside the time in
/// which the loads change: an undamped oscillator under a ramp of length tau overshoots by up to T/(pi tau).
std::vector<diagnostics::EffectChoice> choose_effects(const SolidParameters& parameters,
                                                      const mesh::MeshFacts& mesh,
                                                      const diagnostics::CaseScene& scene);

/// By the numbers of configs/cantilever and cook on one rank.
diagnostics::ExpectedCost expected_cost(const SolidParameters& parameters, const mesh::MeshFacts& mesh);

}  // namespace couplet::solid
