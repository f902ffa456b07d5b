// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "fluid_solver/parameters/effect_cards.hpp"

namespace couplet::fluid {

/// Verdicts of the cards: what the evidence of a run says about what its scene has or neglects; nothing where there is no evidence.
std::optional<effects::EffectVerdict> judge_turbulence(const FluidScene& scene,
                                                       const FluidEvidence& evidence);
std::optional<effects::EffectVerdict> judge_walls(const FluidScene& scene, const FluidEvidence& evidence);
std::optional<effects::EffectVerdict> spare_turbulence(const FluidScene& scene,
                                                       const FluidEvidence& evidence);
std::optional<effects::EffectVerdict> judge_flat_eddies(const FluidScene& scene,
                                                        const FluidEvidence& evidence);
std::optional<effects::EffectVerdict> judge_compressibility(const FluidScene& scene,
                                                            const FluidEvidence& evidence);
std::optional<effects::EffectVerdict> judge_small_changes(const FluidScene& scene,
                                                          const FluidEvidence& evidence);
std::optional<effects::EffectVerdict> judge_waves(const FluidScene& scene, const FluidEvidence& evidence);
std::optional<effects::EffectVerdict> judge_energy(const FluidScene& scene, const FluidEvidence& evidence);
std::optional<effects::EffectVerdict> judge_still_mesh(const FluidScene& scene,
                                                       const FluidEvidence& evidence);
std::optional<effects::EffectVerdict> judge_moving_walls(const FluidScene& scene,
                                                         const FluidEvidence& evidence);
std::optional<effects::EffectVerdict> judge_blocked(const FluidScene& scene, const FluidEvidence& evidence);

}  // namespace couplet::fluid
