// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <linux/filter.h>

#include <filesystem>
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

}  // namespace couplet::mesh
