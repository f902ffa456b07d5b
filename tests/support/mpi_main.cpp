// SPDX-License-Identifier: Apache-2.0
// main() of every test executable: MPI and PETSc are up, only rank 0 prints passing tests, and a failure on
// any rank fails the run.
#include <gtest/gtest.h>
#include <mpi.h>

#include <string>

#include "common/linalg/petsc.hpp"
#include "common/parallel/mpi_start.hpp"
#include "tests/support/chosen_files.hpp"

namespace {

/// The other ranks speak only when they fail.
class FailurePrinter final : public ::testing::EmptyTestEventListener {
 public:
  explicit FailurePrinter(int rank) : rank_(rank) {}
  void OnTestStart(const ::testing::TestInfo& test) override { test_ = test.name(); }
  void OnTestPartResult(const ::testing::TestPartResult& result) override {
    if (!result.failed()) return;
    fprintf(stderr, "rank %d: %s: %s:%d: %s\n", rank_, test_.c_str(),
            result.file_name() ? result.file_name() : "", result.line_number(), result.message());
  }

 private:
  int rank_;
  std::string test_;
};

}  // namespace

int main(int argc, char** argv) {
  ::testing::InitGoogleTest(&argc, argv);
  if (!couplet::testing::choose_files(argc, argv)) return 2;
  // As the programs start: Open MPI's own way to start a process alone waits 0.4 s for a daemon.
  couplet::parallel::prepare_mpi_start();
  MPI_Init(&argc, &argv);
  int result = 0;
  {
    couplet::linalg::PetscEnvironment petsc(MPI_COMM_WORLD);
    int rank = 0;
    MPI_Comm_rank(MPI_COMM_WORLD, &rank);
    auto& listeners = ::testing::UnitTest::GetInstance()->listeners();
    if (rank != 0) {
      delete listeners.Release(listeners.default_result_printer());
      listeners.Append(new FailurePrinter(rank));
    }
    result = RUN_ALL_TESTS();
    if (rank != 0 && result != 0)
      fprintf(stderr, "rank %d failed (see its assertions with one rank)\n", rank);
    MPI_Allreduce(MPI_IN_PLACE, &result, 1, MPI_INT, MPI_MAX, MPI_COMM_WORLD);
  }
  MPI_Finalize();
  return result;
}
