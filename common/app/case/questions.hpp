// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/app/case/case_file.hpp"
#include "common/app/case/command_line.hpp"

namespace couplet::app {

/// --check, --docs, --schema and --print-config: answered without MPI. Returns the exit code.
int answer(const CommandLine& command_line, const ProgramKind& kind);

}  // namespace couplet::app
