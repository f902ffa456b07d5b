// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace couplet::app {

/// What is wrong with the file that a key of a participant names.
struct ProblemOfKey {
  std::string key;   ///< path below the participant: "ambient.file"
  std::string what;  ///< a sentence, with file:line where it can be said
};

}  // namespace couplet::app
