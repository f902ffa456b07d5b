// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <mpi.h>
#include <unistd.h>

#include <filesystem>
#include <string>

#include "common/parallel/collective.hpp"

namespace couplet {

/// A folder of its own for one test, the same on all ranks, gone afterwards.
class Scratch final {
 public:
  Scratch() {
    std::string name = std::filesystem::temp_directory_path() / ("couplet-io-" + std::to_string(::getpid()));
    parallel::broadcast(MPI_COMM_WORLD, name);
    path_ = name;
    if (parallel::comm_rank(MPI_COMM_WORLD) == 0) std::filesystem::create_directories(path_);
    MPI_Barrier(MPI_COMM_WORLD);
  }
  ~Scratch() {
    MPI_Barrier(MPI_COMM_WORLD);
    std::error_code ignored;
    if (parallel::comm_rank(MPI_COMM_WORLD) == 0) std::filesystem::remove_all(path_, ignored);
    MPI_Barrier(MPI_COMM_WORLD);
  }
  std::filesystem::path operator/(const std::string& name) const { return path_ / name; }

 private:
  std::filesystem::path path_;
};

/// The text of the Error that `action` throws; empty if it throws none.
template <class Action>
std::string error_of(Action&& action) {
  try {
    action();
  } catch (const std::exception& error) {
    return error.what();
  }
  return {};
}

}  // namespace couplet
