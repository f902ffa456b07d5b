// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <mpi.h>
#include <unistd.h>

#include <filesystem>
#include <string>

#include "common/io/checkpoint.hpp"

namespace couplet::support {

/// What save() of a run on all ranks of MPI_COMM_WORLD writes, in a file of its own that goes with this object.
class SavedState {
 public:
  template <class Run>
  explicit SavedState(const Run& run) : file_(name()) {
    io::CheckpointWriter writer(MPI_COMM_WORLD, file_);
    run.save(writer);
    writer.close();
  }
  ~SavedState() {
    int rank = 0;
    MPI_Comm_rank(MPI_COMM_WORLD, &rank);
    MPI_Barrier(MPI_COMM_WORLD);
    std::error_code ignored;
    if (rank == 0) std::filesystem::remove(file_, ignored);
  }
  SavedState(const SavedState&) = delete;
  template <class Run>
  void load_into(Run& run) const {
    io::CheckpointReader reader(MPI_COMM_WORLD, file_);
    run.load(reader);
  }

 private:
  /// The same on all ranks, and nobody else's.
  static std::filesystem::path name() {
    int process = ::getpid();
    MPI_Bcast(&process, 1, MPI_INT, 0, MPI_COMM_WORLD);
    return std::filesystem::temp_directory_path() / ("couplet-saved-" + std::to_string(process) + ".h5");
  }

  std::filesystem::path file_;
};

}  // namespace couplet::support
