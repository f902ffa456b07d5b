// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "common/app/case/check_files.hpp"
#include "common/app/case/command_line.hpp"
#include "common/app/case/roll_call.hpp"
#include "common/app/loop/simulation.hpp"
#include "common/config/load.hpp"
#include "common/diagnostics/effects.hpp"

namespace couplet::app {

/// One of the programs of a job, as far as the YAML is concerned.
struct ProgramKind {
  std::string name;                  ///< "solid_solver"
  std::string description;           ///< one line
  bool is_coupler = false;           ///< reads `coupling` instead of a participant's section
  config::Section::Declare declare;  ///< its keys, without `program`
  /// What it can simulate, with the parameters that were read; empty: not told.
  std::function<std::vector<diagnostics::Effect>(const diagnostics::CaseScene&)> effects = {};
  /// What `simulation.effects: auto` decides, with the parameters that were read; empty: nothing.
  std::function<std::vector<diagnostics::EffectChoice>(const diagnostics::CaseScene&)> choose = {};
  /// Memory and time of a step to be expected, for --explain; empty: not told.
  std::function<diagnostics::ExpectedCost(const diagnostics::CaseScene&)> expected = {};
  /// For --check, with the parameters that were read: what is wrong with the files they name.
  std::function<std::vector<ProblemOfKey>(const std::filesystem::path& case_folder)> problems_of_files = {};
};

/// The YAML file as one program sees it: what it could read, and all that is wrong with it.
struct CaseFile {
  std::optional<config::Document> document;  ///< empty if the file could not be read at all
  std::string participant;                   ///< empty if it could not be found
  SimulationParameters simulation;
  std::vector<Expected> expected;  ///< the coupler first, if there is a `coupling` section
  bool coupled = false;
  std::size_t hash = 0;                            ///< of the file with the overrides, as all programs see it
  std::vector<diagnostics::EffectChoice> choices;  ///< of `effects: auto`
  std::vector<std::string> errors;
  std::vector<std::string> doubts;  ///< what is possible but implausible
};

/// Reads the file, applies the overrides, finds this program's participant and fills what `kind.declare`
/// binds. Throws nothing: all that is wrong is in `errors`.
CaseFile read_case(const CommandLine& command_line, const ProgramKind& kind);

/// The declaration of the section that this program reads: its own keys and, for a participant, `program`.
config::Section::Declare section_of(const ProgramKind& kind);

}  // namespace couplet::app
