// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <linux/filter.h>

#include <filesystem>
#include <string>
#include <vector>

namespace couplet::mesh {

/// Rules for a program that reads a file of somebody else: Landlock for files, seccomp for all the rest. It needs no
/// privileges and no namespaces, so it holds in containers and chroots, too. The program may read and start what lies below some
/// folders and write below one; it cannot start a process, open a socket, send a signal, or change modes, owners or times of files.
class Barrier {
 public:
  /// Tells whether the kernel has it.
  static bool is_possible();

  /// Paths of `readable` that do not exist are left out. Throws Error if the kernel refuses the rules.
  Barrier(const std::vector<std::filesystem::path>& readable, const std::filesystem::path& writable);
  ~Barrier();
  Barrier(const Barrier&) = delete;
  /// Puts it up around this process, for good. Only calls to the kernel, as is sound between fork and exec. False: errno says why.
  bool put_up() const;

 private:
  int rules_ = -1;
  std::vector<sock_filter> filter_;
};

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
