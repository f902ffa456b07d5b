// SPDX-License-Identifier: Apache-2.0
// What a participant without an interface owes whoever runs it. It gives nothing, so what it saves is
// compared.
//   struct MyFactory {
//     static std::unique_ptr<Participant> make(MPI_Comm comm);
//     static constexpr double dt = 0.01, restart_tolerance = 0;  // as in contract_suite.hpp
//   };
//   INSTANTIATE_TYPED_TEST_SUITE_P(Mine, StandaloneContract, MyFactory);
// The tank has the same tests in tests/verification/thermocline/tank_test.cpp.
#pragma once

#include "tests/contract/contents.hpp"
#include "tests/contract/contract_suite.hpp"

namespace couplet::contract {

template <class Factory>
class StandaloneContract : public ::testing::Test {
 protected:
  struct Subject {
    std::unique_ptr<coupling::Participant> participant = Factory::make(MPI_COMM_WORLD);
    int steps = 0;

    Subject() { EXPECT_TRUE(participant->initialise().empty()); }
    void solve(double dt = Factory::dt) {
      participant->begin_step({steps * Factory::dt, dt, coupling::Scheme::standalone, steps});
      participant->solve({});
    }
    void step() {
      solve();
      participant->accept_step();
      ++steps;
    }
  };
  static std::filesystem::path file(const char* name) {
    int id = ::getpid();
    MPI_Bcast(&id, 1, MPI_INT, 0, MPI_COMM_WORLD);
    return std::filesystem::temp_directory_path() / ("couplet-alone-" + std::to_string(id) + name);
  }
  static void save(const coupling::Participant& participant, const std::filesystem::path& to) {
    io::CheckpointWriter writer(MPI_COMM_WORLD, to);
    participant.save(writer);
    writer.close();
  }
  static Contents saved(const coupling::Participant& participant) {
    const auto to = file("-saved.h5");
    save(participant, to);
    const Contents all = contents(to);
    MPI_Barrier(MPI_COMM_WORLD);
    if (parallel::comm_rank(MPI_COMM_WORLD) == 0) std::filesystem::remove(to);
    MPI_Barrier(MPI_COMM_WORLD);
    return all;
  }
  static double allowed() {
    return parallel::comm_size(MPI_COMM_WORLD) == 1 ? 0 : Factory::restart_tolerance;
  }
};

TYPED_TEST_SUITE_P(StandaloneContract);

TYPED_TEST_P(StandaloneContract, a_checkpoint_continues_bit_for_bit) {
  typename TestFixture::Subject subject, other;
  for (int i = 0; i < 3; ++i) subject.step();
  const auto file = TestFixture::file(".h5");
  TestFixture::save(*subject.participant, file);
  {
    io::CheckpointReader reader(MPI_COMM_WORLD, file);
    other.participant->load(reader);
  }
  other.steps = subject.steps;
  for (int i = 0; i < 3; ++i) subject.step(), other.step();
  EXPECT_LE(apart(TestFixture::saved(*subject.participant), TestFixture::saved(*other.participant)),
            TestFixture::allowed());
  MPI_Barrier(MPI_COMM_WORLD);
  if (parallel::comm_rank(MPI_COMM_WORLD) == 0) std::filesystem::remove(file);
}

/// As in contract_suite.hpp: what is saved in the end is the same.
TYPED_TEST_P(StandaloneContract, checkpoints_leave_a_run_as_it_is) {
  typename TestFixture::Subject never, once, always;
  for (int i = 0; i < 6; ++i) {
    for (auto* s : {&never, &once, &always}) s->step();
    if (i == 2) TestFixture::saved(*once.participant);
    TestFixture::saved(*always.participant);
  }
  const Contents expected = TestFixture::saved(*never.participant);
  EXPECT_LE(apart(expected, TestFixture::saved(*once.participant)), TestFixture::allowed());
  EXPECT_LE(apart(expected, TestFixture::saved(*always.participant)), TestFixture::allowed());
}

TYPED_TEST_P(StandaloneContract, steps_that_are_not_accepted_leave_the_state_bit_for_bit) {
  typename TestFixture::Subject subject;
  for (int i = 0; i < 3; ++i) subject.step();
  const Contents before = TestFixture::saved(*subject.participant);
  subject.solve();
  subject.solve(TypeParam::dt / 3);
  EXPECT_EQ(apart(before, TestFixture::saved(*subject.participant)), 0);
  subject.step();
  EXPECT_GT(apart(before, TestFixture::saved(*subject.participant)), 0) << "steps do nothing";
}

REGISTER_TYPED_TEST_SUITE_P(StandaloneContract, a_checkpoint_continues_bit_for_bit,
                            checkpoints_leave_a_run_as_it_is,
                            steps_that_are_not_accepted_leave_the_state_bit_for_bit);

}  // namespace couplet::contract
