// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

namespace couplet::effects {

/// What `simulation.effects: auto` knows of a scene beside the participant's own parameters.
struct ChoiceScene {
  std::filesystem::path folder{};  ///< of the YAML
  double end_time = 0, time_step = 0;
  bool coupled = false;
  bool has_mover = false;  ///< `coupling.mesh` names one
};

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

}  // namespace couplet::effects
