// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <linux/filter.h>

#include <filesystem>
#include <string>
#include <vector>

namespace couplet::mesh {

/// Restricts a program that reads a foreign file, by Landlock for files and seccomp for everything else. It
/// needs no privileges or namespaces, so it works in containers. The program may read and execute files below
/// some folders and write below one. It cannot start processes, open sockets or change file attributes.
class Barrier {
 public:
  /// Returns true if the kernel supports it.
  static bool is_possible();

  /// Ignores paths of `readable` that do not exist. Throws Error if the kernel rejects the rules.
  Barrier(const std::vector<std::filesystem::path>& readable, const std::filesystem::path& writable);
  ~Barrier();
  Barrier(const Barrier&) = delete;
  /// Restricts this process for good, only by system calls (safe after fork). False: errno holds the reason.
  bool put_up() const;

 private:
  int rules_ = -1;
  std::vector<sock_filter> filter_;
};

/// Private temporary folder of the user for one run of a program. The destructor removes it, and raises a signal
/// that would have ended this process meanwhile.
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
  int code = 0;    ///< -1 if ended by a signal
  int signal = 0;  ///< 0 if none
};

/// Runs a program found on PATH with its output in `output` and waits for it. The program ends with the
/// thread that started it. Memory, processor time and file sizes are limited. Working directory, home and
/// temporary folder are `folder`. With Landlock, it can write nowhere else, reads only `readable` and system
/// files, and starts no process; see Barrier. Throws Error if it cannot be started.
ProgramEnd run_in_sandbox(const std::vector<std::string>& command, const std::filesystem::path& folder,
                          const std::filesystem::path& output,
                          std::vector<std::filesystem::path> readable = {});

/// Runs a trusted program with the user's rights, environment and working directory. The limits and the end
/// with the thread remain.
ProgramEnd run_trusted(const std::vector<std::string>& command, const std::filesystem::path& output);

}  // namespace couplet::mesh
