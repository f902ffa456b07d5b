// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <spdlog/sinks/sink.h>

#include <string>

namespace couplet::log {

/// Standard output is a terminal and this process was started by itself. Under a launcher (mpirun, srun) several
/// programs share the terminal, and what each says stands as lines.
bool on_terminal();

/// For people: at the start at most ten lines of one width, then one line that renews itself with findings above
/// it, at the end what the run found and spent. What it leaves out stands in the log file. At most 100 columns.
spdlog::sink_ptr terminal_sink();

/// The last line, on a terminal alone: where results lie, and which file there has all lines.
void tell_where(const std::string& folder, const std::string& file);

}  // namespace couplet::log
