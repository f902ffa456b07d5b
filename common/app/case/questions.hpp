// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "common/app/case/case_file.hpp"
#include "common/app/case/command_line.hpp"
#include "common/config/load.hpp"

namespace couplet::app {

/// What --check can tell about the files of a participant without running it: a mesh that is missing or broken,
/// patches that the mesh or `boundaries` has and the other has not, names of `mesh-parameters` that the .geo does not
/// define, other files that are missing. The names of a .geo are those that stand in it as texts; computed ones are
/// not judged.
std::vector<std::string> problems_of_files(const config::Document& document, const std::string& participant,
                                           const std::filesystem::path& case_folder);

/// For --check with --restart: why a run could not go on from that folder. No complete set, a set without the file of this
/// program, files whose digests do not fit, a case that is another one. Empty: nothing, or there is no --restart.
std::string problem_of_restart(const CommandLine& command_line, const CaseFile& file, bool is_coupler);

/// --check, --docs, --schema and --print-config: answered without MPI. Returns the exit code.
int answer(const CommandLine& command_line, const Program& program);

}  // namespace couplet::app
