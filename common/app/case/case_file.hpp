// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "common/app/case/command_line.hpp"
#include "common/app/case/roll_call.hpp"
#include "common/app/loop/step_loop.hpp"
#include "common/app/program.hpp"
#include "common/config/load.hpp"
#include "common/diagnostics/choices.hpp"

namespace couplet::app {

/// View of one program on the YAML file: the values it could read and all errors.
struct CaseFile {
  std::optional<config::Document> document;  ///< empty if the file could not be read
  std::string participant;                   ///< empty if it was not found
  SimulationParameters simulation;
  std::vector<Expected> expected;  ///< the coupler first, if there is a `coupling` section
  bool coupled = false;
  std::size_t hash = 0;                            ///< of the file with overrides, as seen by all programs
  std::vector<diagnostics::EffectChoice> choices;  ///< of `effects: auto`
  std::vector<std::string> errors;
  std::vector<std::string> doubts;  ///< possible but implausible values
};

/// Reads the file, applies the overrides, finds this program's participant and fills the parameters of
/// `program.declare`. Does not throw; all errors are in `errors`.
CaseFile read_case(const CommandLine& command_line, const Program& program);

/// Settings of the case beside the participant's own parameters.
diagnostics::CaseScene scene_of(const CommandLine& command_line, const CaseFile& file);
/// Declares the section that this program reads: its own keys and, for a participant, `program`.
config::Section::Declare section_of(const Program& program);

/// Case in the format of a checkpoint's `keys.txt`: lines "path = value", and "path: content = digest" for
/// each file that a value names.
std::string case_keys(const config::Document& document, const std::filesystem::path& case_folder);

/// Differences between a case and the one that wrote a checkpoint.
struct KeyChanges {
  std::vector<std::string> harmless;  ///< location and duration: times, outputs, names
  std::vector<std::string> physics;   ///< everything else
};
KeyChanges changes_between(const std::string& then, const std::string& now);

/// Returns the changes of the solution by those of the case since the checkpoint in this folder. Throws Error if there are any
/// without `consent` (--restart-with-changes).
std::vector<std::string> check_changes(const std::filesystem::path& checkpoint, const std::string& now,
                                       bool consent);

/// Problems of the roles in a coupled case: unknown participants, participants without a role, programs that
/// cannot play theirs (see roles.hpp). Every program of a job finds the same ones, at its roll call and by
/// --check. `expected` holds all participants of the case.
std::vector<std::string> problems_of_roles(const config::Document& document,
                                           const std::vector<Expected>& expected);

/// Compares the wall mass per area that a fluid assumes at an interface with the density times thickness of
/// the plate behind it. A much larger value indicates a wrong unit, and the coupling would diverge.
std::vector<std::string> check_wall_mass(const config::Document& document);

/// Copies height, direction and opening of a fluid's gap to the coupled structure with `contact.gap`, whose
/// seat it is. The document then behaves as if they were set in `contact`. Returns missing or duplicate
/// settings.
std::vector<std::string> share_seats(config::Document& document);

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
