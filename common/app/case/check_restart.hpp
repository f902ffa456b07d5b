// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "common/app/case/case_file.hpp"

namespace couplet::app {

/// For --check with --restart: why a run could not go on from that folder. No complete set, a set without the file of this
/// program, files whose digests do not fit, a case that is another one. Empty: nothing, or there is no --restart.
std::string problem_of_restart(const CommandLine& command_line, const CaseFile& file, bool is_coupler);

}  // namespace couplet::app
