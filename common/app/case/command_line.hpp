// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "common/config/section.hpp"
#include "common/log/log.hpp"

namespace couplet::app {

/// Command line, which is the same for all programs.
struct CommandLine {
  enum class Task { run, check, docs, schema, print_config, explain } task = Task::run;
  std::filesystem::path case_file;       ///< empty for docs and schema
  std::string participant;               ///< if empty, the only one in the YAML that names this program
  std::vector<std::string> overrides;    ///< "a.b=v", for config::Document::set
  std::filesystem::path restart_folder;  ///< empty for a fresh start
  bool allow_commands = false;           ///< a .geo may run commands and write files
  bool restart_with_changes = false;     ///< consent to changes of the case since the checkpoint
  enum class Strict { no, answer, effects };
  /// Makes warnings about the result fail the run. `effects` includes opinions on neglected effects.
  Strict strict = Strict::no;
  std::vector<std::string> accept;  ///< ids of accepted findings
  log::Verbosity verbosity = log::Verbosity::normal;
};

/// Description of a program in --help.
struct ProgramText {
  std::string name;                  ///< "solid_solver"
  std::string description;           ///< one line
  config::Section::Declare declare;  ///< its parameters; --help lists their first level
};

/// Result of parsing. Without `exit_code` the program continues. Otherwise `output` was printed to standard
/// output (--help, --version: 0) or standard error (invalid command line: 2).
struct ParsedCommandLine {
  CommandLine command_line;
  std::optional<int> exit_code;
  std::string output;
};
ParsedCommandLine parse_command_line(int argc, const char* const* argv, const ProgramText& program);

/// Text "couplet 1.0.0".
std::string version_text();

}  // namespace couplet::app
