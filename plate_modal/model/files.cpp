// SPDX-License-Identifier: Apache-2.0
#include "plate_modal/model/files.hpp"

#include "common/base/error.hpp"
#include "plate_modal/model/build_model.hpp"

namespace couplet::plate {

std::vector<app::ProblemOfKey> problems_of_files(const Parameters& parameters,
                                                 const std::filesystem::path& case_folder) {
  if (!parameters.modes_file) return {};
  try {
    (void)modes_of_file(parameters, case_folder / *parameters.modes_file);
  } catch (const Error& error) {
    return {{"modes.file", error.what()}};
  }
  return {};
}

}  // namespace couplet::plate
