// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "common/effects/prices.hpp"
#include "common/effects/verdict.hpp"

namespace couplet::effects {

/// One effect of a program as data. `asked_by` names what in the scene asks for it (a key with its value), or
/// is empty where it is off. `judge` says of an effect that is off (or, with `judged_when_on`, of one that is
/// on) what the evidence of the run says about it; null: nothing can be said from inside the run. It returns
/// no verdict where it has no evidence.
struct NoEvidence {};

template <class Parameters, class Evidence = NoEvidence>
struct EffectCard {
  const char* name;
  const char* keys;  ///< what switches it on, for the documents
  std::string (*asked_by)(const Parameters&);
  std::string_view
      adds{};  ///< where it is on: fields, matrices, files, processes; nothing of it exists where it is off
  const char* judged_by = "";  ///< the number and its threshold, for the documents
  std::optional<EffectVerdict> (*judge)(const Parameters&, const Evidence&) = nullptr;
  bool judged_when_on = false;
  /// Of an effect that is on: how little it does, and what leaving it out `saves`.
  std::optional<EffectVerdict> (*spare)(const Parameters&, const Evidence&) = nullptr;
};

/// A card looked at with the parameters of a scene.
struct Effect {
  std::string name, keys;
  std::string asked_by;  ///< empty: off
  std::string_view adds;
  std::vector<Price> prices;  ///< of the one list
  std::string judged_by;
  bool judged_when_on = false;
  bool on() const { return !asked_by.empty(); }
};

/// What the job around a participant decides about its effects.
struct EffectScene {
  bool coupled = false;
  bool has_mover = false;                                       ///< `coupling.mesh` names one
  double time_step = std::numeric_limits<double>::quiet_NaN();  ///< [s]; NaN: not known
};

template <class Parameters, class Evidence>
std::vector<Effect> effects_of(std::string_view program,
                               std::span<const EffectCard<Parameters, Evidence>> cards,
                               const Parameters& parameters) {
  std::vector<Effect> effects;
  for (const auto& card : cards)
    effects.push_back({card.name, card.keys, card.asked_by(parameters), card.adds,
                       prices_of(program, card.name), card.judged_by, card.judged_when_on});
  return effects;
}

/// The verdicts that the evidence allows.
template <class Parameters, class Evidence>
std::vector<EffectVerdict> audit(std::span<const EffectCard<Parameters, Evidence>> cards,
                                 const Parameters& parameters, const Evidence& evidence) {
  std::vector<EffectVerdict> verdicts;
  for (const auto& card : cards) {
    const bool on = !card.asked_by(parameters).empty();
    if (card.judge != nullptr && on == card.judged_when_on)
      if (std::optional<EffectVerdict> verdict = card.judge(parameters, evidence)) {
        verdict->effect = card.name;
        verdict->left_out = !card.judged_when_on;
        verdicts.push_back(std::move(*verdict));
      }
    if (card.spare != nullptr && on)
      if (std::optional<EffectVerdict> verdict = card.spare(parameters, evidence)) {
        verdict->effect = card.name;
        verdict->left_out = false;
        verdicts.push_back(std::move(*verdict));
      }
  }
  return verdicts;
}

/// "effects: inertia (analysis: dynamic), gravity (gravity); left out: ...", for the start of a run.
std::string summary(const std::vector<Effect>& effects);

/// A line an effect, for --explain.
std::string explanation(const std::vector<Effect>& effects);

/// The cards as a Markdown table, for docs/effects.md.
std::string markdown(const std::string& program, const std::vector<Effect>& effects);

}  // namespace couplet::effects
