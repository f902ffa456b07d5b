// SPDX-License-Identifier: Apache-2.0
// The ranks of a participant describe the same data, or rank 0 alone describes them.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/base/error.hpp"
#include "common/coupling/serve.hpp"
#include "common/parallel/collective.hpp"

namespace couplet::described_data_test {
using namespace coupling;
namespace {

/// Takes a displacement: on the ranks of which `on` says so.
class Describes : public Participant {
 public:
  explicit Describes(bool on) : on_(on) {}
  Interface initialise() override {
    Interface interface;
    interface.dim = 2;
    if (on_) interface.takes = {{"displacement", "m", Interface::Place::vertices}};
    return interface;
  }
  void begin_step(const Step&) override {}
  Exchange solve(const Exchange&) override { return {}; }
  StepReport accept_step() override { return {}; }
  void save(io::CheckpointWriter&) const override {}
  void load(io::CheckpointReader&) override {}
  void write_output(double, int) override {}
  void write_monitors(double) override {}

 private:
  bool on_;
};

Reply initialise(bool on) {
  Describes participant(on);
  return carry_out(Command{Op::initialise, {}, {}, 0, -1, ""}, participant, "mover", MPI_COMM_WORLD);
}

TEST(DescribedData, on_all_ranks_or_on_the_first_alone) {
  const int rank = parallel::comm_rank(MPI_COMM_WORLD);
  EXPECT_EQ(initialise(true).status, Reply::Status::ok);
  EXPECT_EQ(initialise(rank == 0).status, Reply::Status::ok);
}

TEST(DescribedData, on_another_rank_alone_are_refused_on_all) {
  const int last = parallel::comm_size(MPI_COMM_WORLD) - 1;
  if (last == 0) GTEST_SKIP() << "needs two ranks";
  try {
    initialise(parallel::comm_rank(MPI_COMM_WORLD) == last);
    FAIL() << "nothing was refused";
  } catch (const Error& e) {
    EXPECT_THAT(e.what(), testing::HasSubstr(std::to_string(last) + " describes different data"));
  }
}

}  // namespace
}  // namespace couplet::described_data_test
