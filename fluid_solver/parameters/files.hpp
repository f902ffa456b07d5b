// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <vector>

#include "common/app/case/problem_of_key.hpp"
#include "fluid_solver/parameters/parameters.hpp"

namespace couplet::fluid {

/// The velocities of a boundary from its file, in `dimension` components. Throws Error with file:line.
fv::GridTable velocity_table(const std::filesystem::path& file, fv::GridTable::Outside outside,
                             int dimension);

/// For --check: tables of boundaries that are missing or broken.
std::vector<app::ProblemOfKey> problems_of_files(const FluidParameters& parameters,
                                                 const std::filesystem::path& case_folder);

}  // namespace couplet::fluid
