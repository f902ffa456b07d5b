// SPDX-License-Identifier: Apache-2.0
// Every way to move a mesh on one rank and several, and from a checkpoint.
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>

#include "common/io/checkpoint.hpp"
#include "plate_case.hpp"
#include "tests/support/saved_state.hpp"

namespace couplet::mesh_mover::test::ranks_test {
namespace {

class EveryMethodInParallel : public ::testing::TestWithParam<std::pair<Method, Form>> {};

TEST_P(EveryMethodInParallel, goes_on_from_a_checkpoint_bit_for_bit) {
  const auto [method, form] = GetParam();
  Parameters p = plate_in_a_square(method, form);
  turn_by(p, "0.5*t");
  p.boundaries["plate"].prescribed.displacement = {{"0.1*t*y"}, {"0.1*t*x^2"}};
  Mover mover(p, context());
  mover.initialise();
  run(mover, 0, 0.4, 2);
  const support::SavedState checkpoint(mover);
  const std::vector<double> then = mover.displacement();
  run(mover, 0.4, 1, 2);
  const std::vector<double> end = mover.displacement();
  EXPECT_NE(end, then);
  checkpoint.load_into(mover);
  EXPECT_EQ(mover.displacement(), then);
  run(mover, 0.4, 1, 2);
  EXPECT_EQ(mover.displacement(), end);
}

TEST_P(EveryMethodInParallel, is_not_changed_by_checkpoints) {
  const auto [method, form] = GetParam();
  Parameters p = plate_in_a_square(method, form);
  turn_by(p, "0.5*t");
  Mover never(p, context()), always(p, context());
  for (Mover* mover : {&never, &always}) mover->initialise();
  for (int i = 0; i < 4; ++i) {
    for (Mover* mover : {&never, &always}) run(*mover, 0.1 * i, 0.1 * (i + 1), 1);
    io::StateInMemory memory;
    io::CheckpointWriter writer(memory);
    always.save(writer);
    writer.close();
  }
  EXPECT_EQ(never.displacement(), always.displacement());
}

TEST_P(EveryMethodInParallel, is_the_same_on_any_number_of_ranks) {
  const auto [method, form] = GetParam();
  Parameters p = plate_in_a_square(method, form);
  turn_by(p, "0.4*t");
  p.boundaries["plate"].prescribed.displacement = {{"0"}, {"0.1*t*x^2"}};
  app::ParticipantContext alone = context();
  alone.comm = MPI_COMM_SELF;
  alone.output_folder =
      support::own_folder() / ("alone-" + std::to_string(parallel::comm_rank(MPI_COMM_WORLD)));
  std::filesystem::create_directories(alone.output_folder);
  Mover mover(p, context()), reference(p, alone);
  mover.initialise();
  reference.initialise();
  run(mover, 0, 1, 3);
  run(reference, 0, 1, 3);
  std::vector<double> by_id(reference.displacement().size());
  for (Index v = 0; v < reference.mesh().points.n_local(); ++v)
    for (int c = 0; c < 2; ++c)
      by_id[2 * reference.mesh().point_id[v] + c] = reference.displacement()[2 * v + c];
  double worst = 0;
  for (Index v = 0; v < mover.mesh().points.n_local(); ++v)
    for (int c = 0; c < 2; ++c)
      worst = std::max(worst,
                       std::abs(by_id[2 * mover.mesh().point_id[v] + c] - mover.displacement()[2 * v + c]));
  EXPECT_LT(parallel::max(MPI_COMM_WORLD, worst), 1e-9);
}

INSTANTIATE_TEST_SUITE_P(All, EveryMethodInParallel,
                         ::testing::Values(std::pair{Method::laplacian, Form::total},
                                           std::pair{Method::laplacian, Form::incremental},
                                           std::pair{Method::pseudo_solid, Form::total},
                                           std::pair{Method::pseudo_solid, Form::incremental},
                                           std::pair{Method::rotations, Form::total},
                                           std::pair{Method::barrier, Form::total},
                                           std::pair{Method::barrier, Form::incremental}));

}  // namespace
}  // namespace couplet::mesh_mover::test::ranks_test
