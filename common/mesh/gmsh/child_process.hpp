// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "common/mesh/gmsh/sandbox.hpp"

namespace couplet::mesh {

struct ChildProcess {
  std::vector<std::string> command;      ///< the program with its whole path
  std::vector<std::string> environment;  ///< "NAME=value"
  std::filesystem::path folder;          ///< to work in; empty: as it is
  std::filesystem::path output;
  bool no_new_privileges = true;  ///< false for a program that itself gives privileges up
  bool no_processes = false;      ///< whether it may start none
};

/// Starts it and waits. It gets SIGKILL when the thread that called this ends, so that nothing is left behind by a program
/// that is killed. Throws Error if it cannot be started.
ProgramEnd run_child(const ChildProcess& child);

}  // namespace couplet::mesh
