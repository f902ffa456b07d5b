// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <mpi.h>
#include <unistd.h>

#include <filesystem>
#include <string>

#include "common/parallel/collective.hpp"

namespace couplet::support {

/// Output folder of this job of a test alone, the same on all its ranks (the first call is collective over MPI_COMM_WORLD), gone
/// when it ends: tests that run side by side never write the same file.
inline const std::filesystem::path& own_folder() {
  struct Folder {
    std::filesystem::path path;
    bool made_it = parallel::comm_rank(MPI_COMM_WORLD) == 0;
    Folder() {
      std::string name =
          std::filesystem::temp_directory_path() / ("couplet-test-" + std::to_string(::getpid()));
      parallel::broadcast(MPI_COMM_WORLD, name);
      path = name;
      if (made_it) std::filesystem::create_directories(path);
      MPI_Barrier(MPI_COMM_WORLD);
    }
    ~Folder() {
      std::error_code ignored;
      if (made_it) std::filesystem::remove_all(path, ignored);
    }
  };
  static const Folder folder;
  return folder.path;
}

}  // namespace couplet::support
