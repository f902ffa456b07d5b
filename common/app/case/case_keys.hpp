// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "common/config/load.hpp"

namespace couplet::app {

/// Case in the format of a checkpoint's `keys.txt`: lines "path = value", and "path: content = digest" for
/// each file that a value names.
std::string case_keys(const config::Document& document, const std::filesystem::path& case_folder);

/// Differences between a case and the one that wrote a checkpoint.
struct KeyChanges {
  std::vector<std::string> harmless;  ///< location and duration: times, outputs, names
  std::vector<std::string> physics;   ///< everything else
};
KeyChanges changes_between(const std::string& then, const std::string& now);

/// Reports the changes of the case since the checkpoint in this folder. Throws Error if they change the
/// solution, unless there is `consent` (--restart-with-changes).
void judge_changes(const std::filesystem::path& checkpoint, const std::string& now, bool consent);

}  // namespace couplet::app
