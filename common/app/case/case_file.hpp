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

}  // namespace couplet::app
