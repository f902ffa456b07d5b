// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <vector>

#include "common/app/program.hpp"
#include "thermocline/judge/elsewhere.hpp"

/// Files that the parameters of a tank or of an element name: read before a run, looked at by --check.
namespace couplet::thermocline {

/// The parameters with the rows of flow.file. Throws Error with file:line.
TankParameters with_files(TankParameters parameters, const std::filesystem::path& case_folder);

/// Weather and rows of flows that are missing or broken, a sun that nobody can place: what a run would end with before its
/// first step.
std::vector<app::ProblemOfKey> problems_of_files(const ElementParameters& parameters,
                                                 const std::filesystem::path& case_folder);

}  // namespace couplet::thermocline
