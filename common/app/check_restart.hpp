// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace couplet {

/// What --check can tell about the checkpoint that --restart names, for one participant: a set that is not complete, a
/// file of this participant or of the steps that is missing, damaged or of another kind.
std::vector<std::string> problems_of_restart(const std::filesystem::path& folder,
                                             const std::string& participant);

}  // namespace couplet
