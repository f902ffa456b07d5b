// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <filesystem>
#include <limits>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace couplet::diagnostics {

/// Effect of a program. `asked_by` returns the key and value in the scene that enable it, or an empty string
/// if it is off.
template <class Parameters>
struct EffectEntry {
  const char* name;
  const char* keys;  ///< keys that enable it, for the documentation
  std::string (*asked_by)(const Parameters&);
  /// Fields, matrices, files and processes that exist only while the effect is on.
  std::string_view adds{};
  const char* judged_by = "";  ///< number and limit by which a run judges it, for the documentation
  bool judged_when_on = false;
};

/// Card evaluated for the parameters of a scene.
struct Effect {
  std::string name, keys;
  std::string asked_by;  ///< empty if it is off
  std::string_view adds;
  std::string judged_by;
  bool judged_when_on = false;
  bool on() const { return !asked_by.empty(); }
};

/// Settings of the case beside the participant's own parameters.
struct CaseScene {
  std::filesystem::path folder{};                               ///< of the YAML
  double end_time = 0;                                          ///< [s]
  double time_step = std::numeric_limits<double>::quiet_NaN();  ///< [s]; NaN if unknown
  bool coupled = false;
  bool has_mover = false;  ///< `coupling.mesh` names one
};

template <class Parameters>
std::vector<Effect> effects_of(std::span<const EffectEntry<Parameters>> cards, const Parameters& parameters) {
  std::vector<Effect> effects;
  for (const auto& card : cards)
    effects.push_back(
        {card.name, card.keys, card.asked_by(parameters), card.adds, card.judged_by, card.judged_when_on});
  return effects;
}

/// Summary for the start of a run: "effects: inertia (analysis: dynamic), gravity (gravity); left out: ...".
std::string summary(const std::vector<Effect>& effects);

/// One line per effect, for --explain.
std::string explanation(const std::vector<Effect>& effects);

/// Cards as a Markdown table, for docs/effects.md.
std::string markdown(const std::string& program, const std::vector<Effect>& effects);

/// Decision of `effects: auto`. A key in the YAML is never replaced.
struct EffectChoice {
  std::string key;     ///< of the participant, "analysis"; empty if it is only reported
  std::string value;   ///< as YAML; empty if the key stays unset
  std::string what;    ///< "static"
  std::string reason;  ///< one line with the numbers behind the decision
  bool given = false;  ///< the YAML sets the key, so there was no choice
};

/// Text "auto: analysis: static (nothing changes in time)", or that the key was given.
std::string text(const EffectChoice& choice);

/// Expected cost of a participant on one rank, extrapolated from measured runs of small cases.
struct ExpectedCost {
  std::size_t cells = 0;
  double bytes = 0;           ///< peak, to about a fifth
  double seconds_a_step = 0;  ///< of the solver, to a factor of three, depending on the machine and the flow
};

/// Text "4096 cells: about 54 MB, 20 ms a step on one rank (time to a factor of three)".
std::string text(const ExpectedCost& cost);

}  // namespace couplet::diagnostics
