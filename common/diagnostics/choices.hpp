// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <filesystem>
#include <limits>
#include <string>

namespace couplet::diagnostics {

/// Settings of the case beside the participant's own parameters.
struct CaseScene {
  std::filesystem::path folder{};                               ///< of the YAML
  double end_time = 0;                                          ///< [s]
  double time_step = std::numeric_limits<double>::quiet_NaN();  ///< [s]; NaN if unknown
  bool coupled = false;
  bool has_mover = false;  ///< `coupling.mesh` names one
};

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

}  // namespace couplet::diagnostics
