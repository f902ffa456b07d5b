// SPDX-License-Identifier: Apache-2.0
// What every participant owes its coupler (common/coupling/participant.hpp), as one typed suite. A
// participant joins by a factory:
//   struct MyFactory {
//     static std::unique_ptr<Participant> make(MPI_Comm comm);
//     static Exchange input(const Interface& interface, double factor);  // of this rank; linear in factor
//     static constexpr Scheme scheme = Scheme::implicit;
//     static constexpr double dt = 0.01;
//     static constexpr double repeat_tolerance = 1e-12;  // relative, solve() called again
//     static constexpr double rank_tolerance = 1e-10;    // relative, other numbers of ranks
//     // Of a restart on several ranks; on one it is bit for bit. Not 0 for parallel factorisations (MUMPS),
//     which add
//     // in the order in which messages arrive: two runs of one program differ too.
//     static constexpr double restart_tolerance = 0;
//     // If there is an input that no step can be solved with:
//     static Exchange hopeless(const Interface& interface);
//   };
//   INSTANTIATE_TYPED_TEST_SUITE_P(Mine, ParticipantContract, MyFactory);
#pragma once

#include "common/coupling/participant.hpp"
#include "common/io/checkpoint.hpp"
#include "common/mesh/load.hpp"
#include "tests/contract/contents.hpp"

namespace couplet::contract {

/// One mesh for all participants of a factory on one communicator: a second partitioning within a process may
/// differ from the first, and a checkpoint belongs to its partition.
template <class Factory>
const mesh::LoadedMesh& mesh_of(MPI_Comm comm) {
  static std::map<bool, mesh::LoadedMesh> meshes;
  const auto [place, is_new] = meshes.try_emplace(comm == MPI_COMM_SELF);
  if (is_new)
    place->second =
        mesh::distribute(comm, parallel::comm_rank(comm) == 0 ? Factory::raw_mesh() : mesh::RawMesh{});
  return place->second;
}

/// Largest difference over the largest value of this rank; empty vectors (a rank without places) do not
/// differ.
inline double difference(const coupling::Exchange& a, const coupling::Exchange& b) {
  double worst = 0;
  for (const auto& [name, values] : a) {
    const auto found = b.find(name);
    if (found == b.end() && values.empty()) continue;
    if (found == b.end() || found->second.size() != values.size()) {
      ADD_FAILURE() << name << " is missing or of another size";
      return 1;
    }
    double apart = 0, largest = 0;
    for (std::size_t i = 0; i < values.size(); ++i) {
      apart = std::max(apart, std::abs(values[i] - found->second[i]));
      largest = std::max(largest, std::abs(values[i]));
    }
    worst = std::max(worst, largest > 0 ? apart / largest : apart);
  }
  return worst;
}

/// Of values at the places of `whole` those at the places of `part`, by their numbers.
inline coupling::Exchange part_of(const coupling::Exchange& values, const coupling::Interface& whole,
                                  const coupling::Interface& part) {
  coupling::Exchange result;
  for (const auto& datum : whole.gives) {
    const bool at_vertices = datum.place == coupling::Interface::Place::vertices;
    const auto &ids = at_vertices ? whole.vertex_ids : whole.face_ids,
               &wanted = at_vertices ? part.vertex_ids : part.face_ids;
    const std::size_t entries = at_vertices ? part.vertices.size() : part.face_centres.size();
    if (part.empty()) continue;
    const std::vector<double>& from = values.at(datum.name);
    const auto n = std::size_t(datum.size(whole.dim));
    std::vector<double>& to = result[datum.name];
    for (std::size_t i = 0; i < entries; ++i) {
      const auto k = wanted.empty() ? i : std::size_t(std::ranges::find(ids, wanted[i]) - ids.begin());
      if (k * n + n > from.size()) {
        ADD_FAILURE() << "place " << i << " of " << datum.name << " is not among those of one rank";
        break;
      }
      to.insert(to.end(), from.begin() + std::ptrdiff_t(k * n), from.begin() + std::ptrdiff_t(k * n + n));
    }
  }
  return result;
}

template <class Factory>
class ParticipantContract : public ::testing::Test {
 protected:
  struct Subject {
    std::unique_ptr<coupling::Participant> participant;
    coupling::Interface interface;
    int steps = 0;

    explicit Subject(MPI_Comm comm)
        : participant(Factory::make(comm)), interface(participant->initialise()) {}
    void begin(double dt = Factory::dt) {
      participant->begin_step({steps * Factory::dt, dt, Factory::scheme, steps});
    }
    coupling::Exchange solve(double factor) { return participant->solve(Factory::input(interface, factor)); }
    coupling::Exchange step(double factor) {
      begin();
      const coupling::Exchange out = solve(factor);
      participant->accept_step();
      ++steps;
      return out;
    }
  };
};

TYPED_TEST_SUITE_P(ParticipantContract);

TYPED_TEST_P(ParticipantContract, output_is_what_the_interface_announced) {
  typename TestFixture::Subject subject(MPI_COMM_WORLD);
  const coupling::Exchange out = subject.step(1);
  ASSERT_TRUE(parallel::any(MPI_COMM_WORLD, !subject.interface.empty()));
  if (subject.interface.empty()) return;
  EXPECT_EQ(subject.interface.face_areas.size(), subject.interface.face_centres.size());
  for (const auto& datum : subject.interface.gives) {
    const auto entries = datum.place == coupling::Interface::Place::vertices
                             ? subject.interface.vertices.size()
                             : subject.interface.face_centres.size();
    ASSERT_TRUE(out.contains(datum.name)) << datum.name;
    EXPECT_EQ(out.at(datum.name).size(), entries * datum.size(subject.interface.dim)) << datum.name;
    double largest = 0;
    for (const double v : out.at(datum.name)) largest = std::max(largest, std::abs(v));
    EXPECT_TRUE(std::isfinite(largest));
  }
}

TYPED_TEST_P(ParticipantContract, input_matters) {
  typename TestFixture::Subject subject(MPI_COMM_WORLD);
  subject.begin();
  const coupling::Exchange one = subject.solve(1), other = subject.solve(-2);
  EXPECT_GT(parallel::max(MPI_COMM_WORLD, difference(one, other)), 1e-3);
}

TYPED_TEST_P(ParticipantContract, equal_input_gives_equal_output_within_a_step) {
  typename TestFixture::Subject subject(MPI_COMM_WORLD);
  subject.step(1);
  subject.begin();
  const coupling::Exchange first = subject.solve(1);
  subject.solve(-2);
  EXPECT_LE(difference(first, subject.solve(1)), TypeParam::repeat_tolerance);
}

TYPED_TEST_P(ParticipantContract, a_step_begun_again_forgets_what_was_tried) {
  typename TestFixture::Subject subject(MPI_COMM_WORLD), other(MPI_COMM_WORLD);
  for (auto* s : {&subject, &other}) s->step(1), s->step(0.5);
  subject.begin(TypeParam::dt / 2);
  subject.solve(-3);
  subject.begin();
  subject.solve(2);
  subject.begin();
  other.begin();
  EXPECT_LE(difference(subject.solve(1), other.solve(1)), TypeParam::repeat_tolerance);
}

TYPED_TEST_P(ParticipantContract, only_accepted_steps_change_the_state) {
  typename TestFixture::Subject subject(MPI_COMM_WORLD), other(MPI_COMM_WORLD);
  for (int i = 0; i < 3; ++i) {
    subject.begin();
    subject.solve(-5);
    subject.solve(7);
    EXPECT_LE(difference(subject.step(1 + i), other.step(1 + i)), TypeParam::repeat_tolerance)
        << "step " << i;
  }
}

TYPED_TEST_P(ParticipantContract, a_checkpoint_continues_bit_for_bit) {
  int id = ::getpid();
  MPI_Bcast(&id, 1, MPI_INT, 0, MPI_COMM_WORLD);
  const auto file =
      std::filesystem::temp_directory_path() / ("couplet-contract-" + std::to_string(id) + ".h5");
  typename TestFixture::Subject subject(MPI_COMM_WORLD), other(MPI_COMM_WORLD);
  for (int i = 0; i < 3; ++i) subject.step(1 + i);
  {
    io::CheckpointWriter writer(MPI_COMM_WORLD, file);
    subject.participant->save(writer);
    writer.close();
    io::CheckpointReader reader(MPI_COMM_WORLD, file);
    other.participant->load(reader);
    other.steps = subject.steps;
  }
  const double allowed = parallel::comm_size(MPI_COMM_WORLD) == 1 ? 0 : TypeParam::restart_tolerance;
  for (int i = 0; i < 3; ++i)
    EXPECT_LE(difference(subject.step(2 - i), other.step(2 - i)), allowed) << "step " << i;
  if (parallel::comm_rank(MPI_COMM_WORLD) == 0) std::filesystem::remove(file);
}

/// Whether and how often a run is saved is nothing to it: what a solver learnt from earlier steps (guesses, a
/// preconditioner that lags behind its matrix) survives.
TYPED_TEST_P(ParticipantContract, checkpoints_leave_a_run_as_it_is) {
  typename TestFixture::Subject never(MPI_COMM_WORLD), once(MPI_COMM_WORLD), always(MPI_COMM_WORLD);
  const auto save = [](const coupling::Participant& participant) {
    io::StateInMemory memory;
    io::CheckpointWriter writer(memory);
    participant.save(writer);
    writer.close();
  };
  const double allowed = parallel::comm_size(MPI_COMM_WORLD) == 1 ? 0 : TypeParam::restart_tolerance;
  for (int i = 0; i < 6; ++i) {
    const coupling::Exchange expected = never.step(1 + i);
    EXPECT_LE(difference(expected, once.step(1 + i)), allowed) << "saved once, step " << i;
    EXPECT_LE(difference(expected, always.step(1 + i)), allowed) << "saved always, step " << i;
    if (i == 2) save(*once.participant);
    save(*always.participant);
  }
}

TYPED_TEST_P(ParticipantContract, all_ranks_together_give_what_one_rank_gives) {
  typename TestFixture::Subject together(MPI_COMM_WORLD), alone(MPI_COMM_SELF);
  for (int i = 0; i < 3; ++i) {
    const coupling::Exchange out = together.step(1 + i), expected = alone.step(1 + i);
    EXPECT_LE(difference(part_of(expected, alone.interface, together.interface), out),
              TypeParam::rank_tolerance)
        << "step " << i;
  }
}

/// As a job that gives up writes it: the state before the step, to the bit.
TYPED_TEST_P(ParticipantContract, a_step_that_fails_leaves_state_n_bit_for_bit) {
  if constexpr (requires { TypeParam::hopeless(coupling::Interface{}); }) {
    typename TestFixture::Subject subject(MPI_COMM_WORLD);
    const auto saved = [&] {
      int id = ::getpid();
      MPI_Bcast(&id, 1, MPI_INT, 0, MPI_COMM_WORLD);
      const auto file =
          std::filesystem::temp_directory_path() / ("couplet-failing-" + std::to_string(id) + ".h5");
      io::CheckpointWriter writer(MPI_COMM_WORLD, file);
      subject.participant->save(writer);
      writer.close();
      const Contents all = contents(file);
      MPI_Barrier(MPI_COMM_WORLD);
      if (parallel::comm_rank(MPI_COMM_WORLD) == 0) std::filesystem::remove(file);
      MPI_Barrier(MPI_COMM_WORLD);
      return all;
    };
    for (int i = 0; i < 3; ++i) subject.step(1 + i);
    const Contents before = saved();
    subject.begin();
    EXPECT_THROW(subject.participant->solve(TypeParam::hopeless(subject.interface)), SolveFailure);
    EXPECT_EQ(apart(before, saved()), 0);
    subject.begin();
    subject.solve(1);
    EXPECT_THROW(subject.participant->solve(TypeParam::hopeless(subject.interface)), SolveFailure);
    EXPECT_EQ(apart(before, saved()), 0) << "in a later pass";
    subject.step(1);
  } else {
    GTEST_SKIP() << "no input is hopeless for it";
  }
}

REGISTER_TYPED_TEST_SUITE_P(ParticipantContract, a_step_that_fails_leaves_state_n_bit_for_bit,
                            output_is_what_the_interface_announced, input_matters,
                            equal_input_gives_equal_output_within_a_step,
                            a_step_begun_again_forgets_what_was_tried, only_accepted_steps_change_the_state,
                            a_checkpoint_continues_bit_for_bit, checkpoints_leave_a_run_as_it_is,
                            all_ranks_together_give_what_one_rank_gives);

}  // namespace couplet::contract
