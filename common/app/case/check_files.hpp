// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "common/config/load.hpp"

namespace couplet::app {

/// What --check can tell about the files of a participant without running it: a mesh that is missing or broken,
/// patches that the mesh or `boundaries` has and the other has not, names of `mesh-parameters` that the .geo does not
/// define, other files that are missing. The names of a .geo are those that stand in it as texts; computed ones are
/// not judged.
std::vector<std::string> problems_of_files(const config::Document& document, const std::string& participant,
                                           const std::filesystem::path& case_folder);

}  // namespace couplet::app
