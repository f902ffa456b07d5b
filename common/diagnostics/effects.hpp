// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <filesystem>
#include <limits>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "common/diagnostics/prices.hpp"

namespace couplet::diagnostics {

/// One effect of a program as data. `asked_by` names what in the scene asks for it (a key with its value), or
/// is empty where it is off.
template <class Parameters>
struct EffectCard {
  const char* name;
  const char* keys;  ///< what switches it on, for the documents
  std::string (*asked_by)(const Parameters&);
  /// Where it is on: fields, matrices, files, processes; nothing of it exists where it is off.
  std::string_view adds{};
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

/// What the case says to a participant beside the participant's own parameters.
struct CaseScene {
  std::filesystem::path folder{};                               ///< of the YAML
  double end_time = 0;                                          ///< [s]
  double time_step = std::numeric_limits<double>::quiet_NaN();  ///< [s]; NaN: not known
  bool coupled = false;
  bool has_mover = false;  ///< `coupling.mesh` names one
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

/// One decision of `effects: auto`. A key that the YAML has is never replaced.
struct EffectChoice {
  std::string key;     ///< of the participant, "analysis"; empty: nothing to set, only told
  std::string value;   ///< as YAML; empty: the key stays away
  std::string what;    ///< "static"
  std::string reason;  ///< one line with the numbers that decided
  bool given = false;  ///< the YAML says it: the choice was not made
};

/// "auto: analysis: static (nothing changes in time)", or that the key was given.
std::string text(const EffectChoice& choice);

/// What a run of a participant on one rank is expected to take, from measured runs of small cases.
struct ExpectedCost {
  std::size_t cells = 0;
  double bytes = 0;           ///< at the most, to about a fifth
  double seconds_a_step = 0;  ///< of the solver, to a factor of three: it depends on the machine and the flow
};

/// "4096 cells: about 54 MB, 20 ms a step on one rank (time to a factor of three)"
std::string text(const ExpectedCost& cost);

}  // namespace couplet::diagnostics
