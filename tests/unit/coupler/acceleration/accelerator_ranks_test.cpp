// SPDX-License-Identifier: Apache-2.0
// Vectors spread over ranks give what one rank gives.
#include "common/coupling/channel.hpp"
#include "coupler/acceleration/accelerator.hpp"
#include "tests/support/test.hpp"

namespace couplet::accelerator_ranks_test {
using namespace coupler;
using namespace coupling;

/// 30 modes of a heavy fluid, of which this rank holds those from first to last. Passes of three steps, and
/// the sum of squares of the last x.
std::vector<double> three_steps(AccelerationParameters::Type type, MPI_Comm comm, int first, int last) {
  AccelerationParameters parameters;
  parameters.type = type;
  const auto accelerator = make_accelerator(parameters, comm);
  std::vector<double> passes;
  double square = 0;
  for (int n = 0; n < 3; ++n) {
    Iterate x{std::vector<double>(last - first, 0.), {}};
    accelerator->start_step();
    for (int k = 1; k < 100; ++k) {
      Iterate image = x;
      double sums[2] = {0, 0};
      for (int i = first; i < last; ++i) {
        double& h = image.unknown[i - first];
        h = -10. / (i + 1) * h + (1 + 0.2 * n) / (i + 1);
        sums[0] += std::pow(h - x.unknown[i - first], 2), sums[1] += h * h;
      }
      sum_over(comm, sums);
      square = sums[1];
      if (sums[0] < 1e-16 * sums[1]) {
        accelerator->accept(x, image);
        passes.push_back(k);
        break;
      }
      x = accelerator->next(x, image);
    }
  }
  passes.push_back(square);
  return passes;
}

TEST(Accelerators, do_not_depend_on_the_ranks) {
  using Type = AccelerationParameters::Type;
  const int rank = parallel::comm_rank(MPI_COMM_WORLD), ranks = parallel::comm_size(MPI_COMM_WORLD);
  for (const Type type : {Type::aitken, Type::iqn_ils}) {
    const auto alone = three_steps(type, MPI_COMM_SELF, 0, 30);
    // The last rank holds nothing where there are three.
    const int parts = ranks > 2 ? ranks - 1 : ranks;
    const auto shared = three_steps(type, MPI_COMM_WORLD, 30 * std::min(rank, parts) / parts,
                                    30 * std::min(rank + 1, parts) / parts);
    ASSERT_EQ(alone.size(), 4u);
    ASSERT_EQ(shared.size(), 4u);
    for (int n = 0; n < 3; ++n) EXPECT_EQ(shared[n], alone[n]) << int(type);
    EXPECT_NEAR(shared[3], alone[3], 1e-10 * alone[3]);
  }
}

// The ranks of a participant describe the same data, or rank 0 alone describes them.

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
  EXPECT_THAT(support::error_of([&] { initialise(parallel::comm_rank(MPI_COMM_WORLD) == last); }),
              testing::HasSubstr(std::to_string(last) + " describes different data"));
}

}  // namespace couplet::accelerator_ranks_test
