// SPDX-License-Identifier: Apache-2.0
#include "common/app/check_restart.hpp"

#include "common/app/step_loop.hpp"
#include "common/base/error.hpp"
#include "common/io/checkpoint.hpp"

namespace couplet {

std::vector<std::string> problems_of_restart(const std::filesystem::path& folder,
                                             const std::string& participant) {
  std::vector<std::string> problems;
  try {
    const std::filesystem::path set = find_checkpoint(folder);
    for (const std::string& name : {participant + ".h5", std::string(run_file)})
      if (const std::string problem = problem_of_checkpoint(set / name); !problem.empty())
        problems.push_back("--restart: " + problem);
  } catch (const Error& error) {
    problems.push_back(error.what());
  }
  return problems;
}

}  // namespace couplet
