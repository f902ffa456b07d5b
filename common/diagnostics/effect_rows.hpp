// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "common/diagnostics/diagnostics.hpp"
#include "common/diagnostics/effects.hpp"

namespace couplet::diagnostics {

/// How the evidence of a run judges one effect of a program.
template <class Scene, class Evidence>
struct EffectRow {
  const char* effect;  ///< its name, as on its card
  /// The number, or nothing where there is no evidence.
  std::optional<EffectFinding> (*judge)(const Scene&, const Evidence&);
  bool when_on = false;  ///< judged where the scene has the effect, not where it leaves it out
};

/// The findings that the evidence allows.
template <class Scene, class Evidence>
std::vector<Finding> effect_findings(std::span<const EffectRow<Scene, Evidence>> rows,
                                     std::span<const EffectCard<Scene>> cards, const Scene& scene,
                                     const Evidence& evidence) {
  std::vector<Finding> findings;
  for (const auto& row : rows)
    for (const auto& card : cards) {
      if (std::string_view(card.name) != row.effect || card.asked_by(scene).empty() == row.when_on) continue;
      std::optional<EffectFinding> effect = row.judge(scene, evidence);
      if (!effect) continue;
      effect->effect = row.effect;
      effect->left_out = !row.when_on;
      if (auto finding = finding_of(*effect)) findings.push_back(std::move(*finding));
    }
  return findings;
}

}  // namespace couplet::diagnostics
