// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <limits>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "common/effects/prices.hpp"

namespace couplet::effects {

/// One effect of a program as data. `asked_by` names what in the scene asks for it (a key with its value), or
/// is empty where it is off.
template <class Parameters>
struct EffectCard {
  const char* name;
  const char* keys;  ///< what switches it on, for the documents
  std::string (*asked_by)(const Parameters&);
  std::string_view
      adds{};  ///< where it is on: fields, matrices, files, processes; nothing of it exists where it is off
  const char* judged_by = "";  ///< the number and its limit by which a run judges it, for the documents
  bool judged_when_on = false;
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

template <class Parameters>
std::vector<Effect> effects_of(std::string_view program, std::span<const EffectCard<Parameters>> cards,
                               const Parameters& parameters) {
  std::vector<Effect> effects;
  for (const auto& card : cards)
    effects.push_back({card.name, card.keys, card.asked_by(parameters), card.adds,
                       prices_of(program, card.name), card.judged_by, card.judged_when_on});
  return effects;
}

/// "effects: inertia (analysis: dynamic), gravity (gravity); left out: ...", for the start of a run.
std::string summary(const std::vector<Effect>& effects);

/// A line an effect, for --explain.
std::string explanation(const std::vector<Effect>& effects);

/// The cards as a Markdown table, for docs/effects.md.
std::string markdown(const std::string& program, const std::vector<Effect>& effects);

}  // namespace couplet::effects
