// SPDX-License-Identifier: Apache-2.0
// Vectors spread over ranks give what one rank gives.
#include <gtest/gtest.h>

#include <cmath>

#include "common/parallel/collective.hpp"
#include "coupler/acceleration/accelerator.hpp"

namespace couplet::accelerator_ranks_test {
using namespace coupler;
namespace {

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
  for (const Type type : {Type::aitken, Type::iqn_ils, Type::iqn_mvj}) {
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

}  // namespace
}  // namespace couplet::accelerator_ranks_test
