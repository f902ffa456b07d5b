// SPDX-License-Identifier: Apache-2.0
#include "common/coupling/messages.hpp"

#include "common/coupling/wait.hpp"
#include "tests/support/test.hpp"

namespace couplet::messages_test {
using namespace coupling;

/// A message of one process to itself.
void carry(const std::vector<std::span<const double>>& values, const Stretches& to) {
  SendAll sending(MPI_COMM_SELF);
  sending.add(0, input_tag, values);
  try {
    receive_stretches(MPI_COMM_SELF, 0, input_tag, to, "values");
  } catch (...) {
    sending.wait("");
    throw;
  }
  sending.wait("");
}

Command some_command() {
  Command c;
  c.op = Op::solve;
  c.step = {1.5, 0.25, Scheme::implicit, 7};
  c.step.sub_steps = 3;
  c.data = {{"displacement", {1, -2.5e-300, NAN}}, {"velocity", {}}};
  c.time = 1.75;
  c.output = 3;
  c.folder = "out/checkpoints/step-00000001";
  return c;
}

Reply some_reply() {
  Reply r;
  r.status = Reply::Status::failure;
  r.text = "cell 12 is inverted";
  r.seconds = 0.125;
  r.data = {{"pressure-force", {1, 2}}};
  r.interface.dim = 2;
  r.renewed = true;
  r.interface.takes = {{"displacement", "m", Interface::Place::vertices}};
  r.interface.gives = {{"pressure-force", "N", Interface::Place::faces}};
  r.report = {.dt = 0.25, .iterations = 17, .energy = 3e-9};
  return r;
}

TEST(Messages, commands_arrive_as_they_were_sent) {
  const Command sent = some_command(), got = unpack_command(pack(sent));
  EXPECT_EQ(got.op, sent.op);
  EXPECT_EQ(got.step.time, sent.step.time);
  EXPECT_EQ(got.step.dt, sent.step.dt);
  EXPECT_EQ(got.step.scheme, sent.step.scheme);
  EXPECT_EQ(got.step.number, sent.step.number);
  EXPECT_EQ(got.time, sent.time);
  EXPECT_EQ(got.output, sent.output);
  EXPECT_EQ(got.folder, sent.folder);
  EXPECT_EQ(got.step.sub_steps, 3);
  // Names alone: the values go from rank to rank.
  EXPECT_EQ(got.data, (Exchange{{"displacement", {}}, {"velocity", {}}}));
}

const Partition some_cut{{0, 5, 7}, {0, 0, 9}};

TEST(Messages, replies_arrive_as_they_were_sent) {
  Partition cut;
  const Reply sent = some_reply(), got = unpack_reply(pack(sent, some_cut), cut);
  EXPECT_EQ(cut.vertices, some_cut.vertices);
  EXPECT_EQ(cut.faces, some_cut.faces);
  EXPECT_EQ(got.status, sent.status);
  EXPECT_EQ(got.text, sent.text);
  EXPECT_EQ(got.seconds, sent.seconds);
  EXPECT_TRUE(std::isinf(got.suggested_dt));
  EXPECT_EQ(got.data, (Exchange{{"pressure-force", {}}}));
  EXPECT_EQ(got.interface.dim, 2);
  EXPECT_TRUE(got.renewed);
  ASSERT_EQ(got.interface.gives.size(), 1u);
  EXPECT_EQ(got.interface.gives[0].name, "pressure-force");
  EXPECT_EQ(got.interface.gives[0].unit, "N");
  EXPECT_EQ(got.interface.gives[0].place, Interface::Place::faces);
  EXPECT_EQ(got.report.dt, 0.25);
  EXPECT_EQ(got.report.iterations, 17);
  EXPECT_TRUE(std::isnan(got.report.error));
  EXPECT_EQ(got.report.energy, 3e-9);
}

TEST(Messages, a_message_cut_anywhere_is_refused) {
  const std::vector<char> command = pack(some_command()), reply = pack(some_reply(), some_cut);
  Partition cut;
  for (std::size_t n = 0; n < command.size(); ++n)
    EXPECT_THROW(unpack_command({command.data(), n}), Error) << n << " of " << command.size() << " bytes";
  for (std::size_t n = 0; n < reply.size(); ++n)
    EXPECT_THROW(unpack_reply({reply.data(), n}, cut), Error) << n << " of " << reply.size() << " bytes";
}

TEST(Messages, another_kind_or_version_is_refused) {
  std::vector<char> bytes = pack(some_reply(), some_cut);
  Partition cut;
  EXPECT_THROW(unpack_command(bytes), Error);
  bytes[8] = 99;  // the version follows the 8-byte mark
  EXPECT_EQ(support::error_of([&] { unpack_reply(bytes, cut); }),
            "A reply has protocol version 99, but this program uses version 8: use programs of one version.");
}

Interface two_faces() {
  Interface i;
  i.dim = 2;
  i.vertices = {{0, 0, 0}, {1, 0, 0}, {2, 1, 0}};
  i.face_centres = {{0.5, 0, 0}, {1.5, 0.5, 0}};
  i.face_areas = {{0, 1, 0}, {-1, 1, 0}};
  i.vertex_ids = {10, 11, 12};
  i.face_ids = {20, 21};
  i.face_offset = {0, 2, 4};
  i.face_vertices = {0, 1, 1, 2};
  i.takes = {{"displacement", "m", Interface::Place::vertices}, {"heat", "W", Interface::Place::faces, 1}};
  return i;
}

TEST(Messages, places_cut_in_pieces_are_put_together_again) {
  const Interface whole = two_faces();
  Interface again;
  std::vector<int> surfaces;
  for (const Slice& s : {Slice{0, 1, 0, 0}, Slice{1, 2, 0, 1}, Slice{0, 0, 1, 1}})
    put_back(cut_out(whole, s), again, surfaces);
  EXPECT_TRUE(surfaces.empty());
  EXPECT_EQ(again.vertices, whole.vertices);
  EXPECT_EQ(again.face_centres, whole.face_centres);
  EXPECT_EQ(again.face_areas, whole.face_areas);
  EXPECT_EQ(again.vertex_ids, whole.vertex_ids);
  EXPECT_EQ(again.face_ids, whole.face_ids);
  EXPECT_EQ(again.face_offset, whole.face_offset);
  EXPECT_EQ(again.face_vertices, whole.face_vertices);
  const std::vector<char> bytes = cut_out(whole, {0, 3, 0, 2});
  for (std::size_t n = 0; n < bytes.size(); ++n)
    EXPECT_THROW(put_back({bytes.data(), n}, again, surfaces), Error) << n;
}

TEST(Messages, values_cut_in_pieces_are_put_together_again_and_wrong_lengths_are_named) {
  const Interface i = two_faces();
  const Exchange whole{{"displacement", {1, 2, 3, 4, 5, 6}}, {"heat", {7, 8}}};
  const auto data = present(whole, i.takes, "solid");
  Exchange again{{"displacement", std::vector<double>(6)}, {"heat", std::vector<double>(2)}};
  for (const Slice& s : {Slice{0, 1, 0, 1}, Slice{1, 2, 1, 1}})
    carry(cut_out(whole, data, 2, s, "solid"), places_in(again, data, 2, s, "solid"));
  EXPECT_EQ(again, whole);
  // All data have other places than were announced, or one alone.
  EXPECT_THROW(
      carry(cut_out(whole, data, 2, {0, 2, 0, 1}, "solid"), places_in(again, data, 2, {0, 1, 0, 1}, "solid")),
      Error);
  EXPECT_THROW(
      carry(cut_out(whole, data, 2, {0, 1, 0, 1}, "solid"), places_in(again, data, 2, {0, 2, 0, 1}, "solid")),
      Error);
  EXPECT_THROW(
      carry(cut_out(whole, data, 2, {0, 3, 0, 0}, "solid"), places_in(again, data, 2, {0, 2, 0, 0}, "solid")),
      Error);
  EXPECT_EQ(support::error_of([&] {
              cut_out({{"displacement", {1, 2}}, {"heat", {7, 8}}}, data, 2, {0, 3, 0, 2}, "solid");
            }),
            "'solid' gave 2 values of 'displacement', but its interface has 3 vertices of 2 components.");
  EXPECT_THROW(present({{"colour", {}}}, i.takes, "solid"), Error);
}

TEST(Blocks, a_list_cut_in_two_ways_overlaps_where_it_should) {
  const Starts mine{0, 4, 10}, theirs{0, 3, 3, 7, 10};
  const auto list = overlaps(mine, 1, theirs);
  ASSERT_EQ(list.size(), 2u);
  EXPECT_EQ(list[0].rank, 2);
  EXPECT_EQ(list[0].first, 0u);
  EXPECT_EQ(list[0].count, 3u);
  EXPECT_EQ(list[1].rank, 3);
  EXPECT_EQ(list[1].first, 3u);
  EXPECT_EQ(list[1].count, 3u);
  EXPECT_EQ(owner_of(theirs, 3), 2) << "not the empty one";
  EXPECT_EQ(even_starts(10, 3), (Starts{0, 3, 6, 10}));
}

}  // namespace couplet::messages_test
