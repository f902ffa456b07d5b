// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "common/config/load.hpp"

namespace couplet::app {

/// The case as it stands in `keys.txt` of a checkpoint: "path = value" a line, and "path: content = digest" for each
/// file that a value names.
std::string case_keys(const config::Document& document, const std::filesystem::path& case_folder);

/// How a case differs from the one that a checkpoint was written with.
struct KeyChanges {
  std::vector<std::string> harmless;  ///< where and how long: times, outputs, names
  std::vector<std::string> physics;   ///< everything else
};
KeyChanges changes_between(const std::string& then, const std::string& now);

/// Tells the changes of the case since the checkpoint in this folder; throws Error for those that change what is
/// solved unless there is `consent` (--restart-with-changes).
void judge_changes(const std::filesystem::path& checkpoint, const std::string& now, bool consent);

}  // namespace couplet::app
