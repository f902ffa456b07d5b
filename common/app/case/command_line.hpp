// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "common/config/section.hpp"
#include "common/log/log.hpp"

namespace couplet::app {

/// What a program was asked to do; the same for all programs.
struct CommandLine {
  enum class Task { run, check, docs, schema, print_config, explain, effects } task = Task::run;
  std::filesystem::path case_file;       ///< empty for docs, schema and effects
  std::string participant;               ///< empty: the only one in the YAML that names this program
  std::vector<std::string> overrides;    ///< "a.b=v", for config::Document::set
  std::filesystem::path restart_folder;  ///< empty: fresh start
  bool allow_commands = false;           ///< a .geo may run commands and write files
  bool restart_with_changes = false;     ///< consent to changes of the case since the checkpoint
  enum class Strict { no, answer, effects };
  /// Warnings about the answer fail the run; with `effects` opinions on neglected effects, too.
  Strict strict = Strict::no;
  std::vector<std::string> accept;  ///< ids of findings that are let pass
  log::Verbosity verbosity = log::Verbosity::normal;
};

/// How a program presents itself in --help.
struct ProgramText {
  std::string name;                  ///< "solid_solver"
  std::string description;           ///< one line
  config::Section::Declare declare;  ///< its parameters: --help lists the first level of them
};

/// What to do now: go on with the command line, or leave with this exit code after `output` was printed (--help,
/// --version: 0 and standard output; a wrong command line: 2 and standard error).
struct ParsedCommandLine {
  CommandLine command_line;
  std::optional<int> exit_code;
  std::string output;
};
ParsedCommandLine parse_command_line(int argc, const char* const* argv, const ProgramText& program);

/// "couplet 1.0.0".
std::string version_text();

}  // namespace couplet::app
