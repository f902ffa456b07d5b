// SPDX-License-Identifier: Apache-2.0
#include "common/app/case/check_restart.hpp"

#include "common/app/case/case_keys.hpp"
#include "common/app/case/roll_call.hpp"
#include "common/app/loop/step_loop.hpp"
#include "common/base/error.hpp"
#include "common/io/checkpoint.hpp"
#include "common/io/checkpoint_set.hpp"

namespace couplet::app {

std::string problem_of_restart(const CommandLine& command_line, const CaseFile& file, bool is_coupler) {
  if (command_line.restart_folder.empty()) return "";
  const std::string own = (is_coupler ? std::string(coupler_name) : file.participant) + ".h5";
  try {
    const std::filesystem::path folder = find_checkpoint(command_line.restart_folder);
    const auto set = io::read_checkpoint_set(folder);
    bool has_own = false;
    for (const io::CheckpointSet::File& part : set->files) {
      if (const std::string problem = io::problem_in_set(folder / part.name); !problem.empty())
        return fmt::format("--restart {}: {}", folder.string(), problem);
      has_own = has_own || part.name == own;
      if (part.name == own || part.name == run_file)
        if (const std::string problem = io::problem_of_checkpoint(folder / part.name); !problem.empty())
          return fmt::format("--restart {}: {}", folder.string(), problem);
    }
    if (!has_own)
      return fmt::format(
          "--restart {}: the checkpoint has no file {}: the run that wrote it did not include this program.",
          folder.string(), own);
    if (is_coupler || !file.coupled)
      judge_changes(folder, case_keys(*file.document, command_line.case_file.parent_path()),
                    command_line.restart_with_changes);
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

}  // namespace couplet::app
