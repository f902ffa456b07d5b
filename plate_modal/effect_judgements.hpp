// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "plate_modal/effect_cards.hpp"

namespace couplet::plate {

/// Verdicts of the cards: what the evidence of a run says about what its scene has or neglects; nothing where there is no evidence.
std::optional<effects::EffectVerdict> judge_rotation(const PlateScene& scene, const PlateEvidence& evidence);
std::optional<effects::EffectVerdict> judge_in_plane(const PlateScene& scene, const PlateEvidence& evidence);
std::optional<effects::EffectVerdict> judge_kept(const PlateScene& scene, const PlateEvidence& evidence);
std::optional<effects::EffectVerdict> judge_load_beyond(const PlateScene& scene,
                                                        const PlateEvidence& evidence);
std::optional<effects::EffectVerdict> judge_velocity(const PlateScene& scene, const PlateEvidence& evidence);
std::optional<effects::EffectVerdict> judge_within(const PlateScene& scene, const PlateEvidence& evidence);
std::optional<effects::EffectVerdict> judge_mesh(const PlateScene& scene, const PlateEvidence& evidence);
std::optional<effects::EffectVerdict> judge_stretch(const PlateScene& scene, const PlateEvidence& evidence);
std::optional<effects::EffectVerdict> judge_lost(const PlateScene& scene, const PlateEvidence& evidence);
std::optional<effects::EffectVerdict> judge_no_part(const PlateScene& scene, const PlateEvidence& evidence);
std::optional<effects::EffectVerdict> judge_shear(const PlateScene& scene, const PlateEvidence& evidence);
std::optional<effects::EffectVerdict> judge_step(const PlateScene& scene, const PlateEvidence& evidence);
std::optional<effects::EffectVerdict> judge_resonance(const PlateScene& scene, const PlateEvidence& evidence);
std::optional<effects::EffectVerdict> judge_load(const PlateScene& scene, const PlateEvidence& evidence);
std::optional<effects::EffectVerdict> judge_contact(const PlateScene& scene, const PlateEvidence& evidence);
std::optional<effects::EffectVerdict> judge_energy(const PlateScene& scene, const PlateEvidence& evidence);

}  // namespace couplet::plate
