// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <spdlog/sinks/sink.h>

#include <string>

namespace couplet::log {

/// Where standard output leads to: a file or pipe, a terminal of this process, or the terminal of the mpirun that
/// started it, which the programs of a job share (where mpirun marks or files their lines: none).
enum class Screen { none, own, shared };
Screen screen();

/// For people: at the start at most ten lines of one width, then one line that renews itself with findings above
/// it, at the end what the run found and spent. What it leaves out stands in the log file. At most 100 columns.
/// On a shared terminal the program that makes the steps has the status line; the others print a line at their
/// start and their warnings.
spdlog::sink_ptr terminal_sink(Screen screen, bool is_first_rank);

/// Before the log is set up: whether this program makes the steps of its job.
void set_driver(bool is_driver);

/// The last line, on a terminal alone: where results lie, and which file there has all lines.
void tell_where(const std::string& folder, const std::string& file);

}  // namespace couplet::log
