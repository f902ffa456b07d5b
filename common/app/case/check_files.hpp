// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "common/config/load.hpp"

namespace couplet::app {

struct CommandLine;
struct CaseFile;

/// What --check can tell about the files of a participant without running it: a mesh that is missing or broken,
/// patches that the mesh or `boundaries` has and the other has not, names of `mesh-parameters` that the .geo does not
/// define, other files that are missing. The names of a .geo are those that stand in it as texts; computed ones are
/// not judged.
std::vector<std::string> problems_of_files(const config::Document& document, const std::string& participant,
                                           const std::filesystem::path& case_folder);

/// For --check with --restart: why a run could not go on from that folder. No complete set, a set without the file of this
/// program, files whose digests do not fit, a case that is another one. Empty: nothing, or there is no --restart.
std::string problem_of_restart(const CommandLine& command_line, const CaseFile& file, bool is_coupler);

/// A fault of the file that a key of a participant names.
struct ProblemOfKey {
  std::string key;   ///< path below the participant: "ambient.file"
  std::string what;  ///< a sentence, with file:line where it can be said
};

}  // namespace couplet::app
