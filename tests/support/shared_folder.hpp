// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <mpi.h>
#include <unistd.h>

#include <filesystem>
#include <string>

#include "common/parallel/collective.hpp"

namespace couplet::support {

/// An empty folder that all ranks share for one run; rank 0 removes it at the end. Collective over MPI_COMM_WORLD, one at a time.
class SharedFolder {
 public:
  SharedFolder() {
    const bool root = parallel::comm_rank(MPI_COMM_WORLD) == 0;
    const GlobalIndex process = parallel::sum(MPI_COMM_WORLD, GlobalIndex(root ? ::getpid() : 0));
    path_ = std::filesystem::temp_directory_path() / ("couplet-shared-" + std::to_string(process));
    if (root) std::filesystem::create_directories(path_);
    MPI_Barrier(MPI_COMM_WORLD);
  }
  ~SharedFolder() {
    MPI_Barrier(MPI_COMM_WORLD);
    if (parallel::comm_rank(MPI_COMM_WORLD) == 0) std::filesystem::remove_all(path_);
    MPI_Barrier(MPI_COMM_WORLD);
  }
  SharedFolder(const SharedFolder&) = delete;
  SharedFolder& operator=(const SharedFolder&) = delete;
  const std::filesystem::path& path() const { return path_; }
  std::filesystem::path operator/(const std::string& name) const { return path_ / name; }

 private:
  std::filesystem::path path_;
};

}  // namespace couplet::support
