// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "common/diagnostics/choices.hpp"
#include "common/mesh/gmsh/gmsh.hpp"
#include "solid_solver/parameters/parameters.hpp"

namespace couplet::solid {

/// Resolves `effects: auto` of a solid: dimension and inertia. Inertia is judged by the lowest period of a
/// clamped bar of the size of the mesh, T = 2 pi L^2/(3.516 h) sqrt(12 rho/E), relative to the time scale tau
/// of the loads: an undamped oscillator overshoots a ramp by up to T/(pi tau).
std::vector<diagnostics::EffectChoice> choose_effects(const SolidParameters& parameters,
                                                      const mesh::MeshFacts& mesh,
                                                      const diagnostics::CaseScene& scene);

/// Estimates the cost from configs/cantilever and cook on one rank.

}  // namespace couplet::solid
