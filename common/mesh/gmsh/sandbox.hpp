// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace couplet::mesh {

/// A new folder for one run of a program, only for this user, in the folder for temporary files; gone with this object.
class OwnFolder {
 public:
  OwnFolder();
  ~OwnFolder();
  OwnFolder(const OwnFolder&) = delete;
  OwnFolder& operator=(const OwnFolder&) = delete;
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

struct ProgramEnd {
  int code = 0;    ///< -1: by a signal
  int signal = 0;  ///< 0: none
};

/// Runs a program found on PATH, its output in `output`, and waits for it. It ends with the thread that started it, however
/// that ends. Limits on memory, processor time and size of files. Its working directory, home and temporary folder are
/// `folder`. Where the kernel has Landlock, it can write nowhere else, reads only `readable` and what it needs of the system, and
/// starts no process; see Barrier. Throws Error if it cannot be started.
ProgramEnd run_in_sandbox(const std::vector<std::string>& command, const std::filesystem::path& folder,
                          const std::filesystem::path& output,
                          std::vector<std::filesystem::path> readable = {});

/// The same with the user's rights, environment and working directory, but for the limits and the end: for what the user
/// trusts.
ProgramEnd run_trusted(const std::vector<std::string>& command, const std::filesystem::path& output);

}  // namespace couplet::mesh
