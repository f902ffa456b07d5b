// SPDX-License-Identifier: Apache-2.0
#include "fluid_solver/parameters/files.hpp"

#include "common/base/error.hpp"

namespace couplet::fluid {

fv::GridTable velocity_table(const std::filesystem::path& file, fv::GridTable::Outside outside,
                             int dimension) {
  std::vector<std::string> columns{"u", "v", "w"};
  columns.resize(std::size_t(dimension));
  return fv::GridTable::read(file, columns, outside);
}

std::vector<app::ProblemOfKey> problems_of_files(const FluidParameters& parameters,
                                                 const std::filesystem::path& case_folder) {
  std::vector<app::ProblemOfKey> all;
  for (const auto& [patch, boundary] : parameters.boundaries) {
    if (!boundary.table) continue;
    try {
      (void)velocity_table(case_folder / boundary.table->file, boundary.table->outside, parameters.dimension);
    } catch (const Error& error) {
      all.push_back({"boundaries." + patch + ".table.file", error.what()});
    }
  }
  return all;
}

}  // namespace couplet::fluid
