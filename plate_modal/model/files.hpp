// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <vector>

#include "common/app/case/check_files.hpp"
#include "plate_modal/model/parameters.hpp"

namespace couplet::plate {

/// For --check: modes that are missing, broken or of no structure.
std::vector<app::ProblemOfKey> problems_of_files(const Parameters& parameters,
                                                 const std::filesystem::path& case_folder);

}  // namespace couplet::plate
