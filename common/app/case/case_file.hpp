// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "common/app/case/command_line.hpp"
#include "common/app/case/roll_call.hpp"
#include "common/app/loop/simulation.hpp"
#include "common/app/program.hpp"
#include "common/config/load.hpp"
#include "common/diagnostics/effects.hpp"

namespace couplet::app {

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

/// Reads the file, applies the overrides, finds this program's participant and fills what `program.declare`
/// binds. Throws nothing: all that is wrong is in `errors`.
CaseFile read_case(const CommandLine& command_line, const Program& program);

/// What the case says beside the participant's own parameters.
diagnostics::CaseScene scene_of(const CommandLine& command_line, const CaseFile& file);
/// The declaration of the section that this program reads: its own keys and, for a participant, `program`.
config::Section::Declare section_of(const Program& program);

}  // namespace couplet::app
