// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "common/app/case/case_file.hpp"
#include "common/app/case/command_line.hpp"
#include "common/config/load.hpp"

namespace couplet::app {

/// Problems that --check finds in the files of a participant without running it: a missing or damaged mesh,
/// patches that only the mesh or only `boundaries` has, `mesh-parameters` that the .geo does not define, and
/// other missing files. Names computed in a .geo are not checked.
std::vector<std::string> problems_of_files(const config::Document& document, const std::string& participant,
                                           const std::filesystem::path& case_folder);

/// Reason why --restart could not continue from its folder, for --check: no complete set, no file of this
/// program, wrong digests, or another case. Empty if it could, or without --restart.
std::string problem_of_restart(const CommandLine& command_line, const CaseFile& file, bool is_coupler);

/// Answers --check, --docs, --schema and --print-config without MPI. Returns the exit code.
int answer(const CommandLine& command_line, const Program& program);

}  // namespace couplet::app
