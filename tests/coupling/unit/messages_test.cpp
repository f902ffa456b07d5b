// SPDX-License-Identifier: Apache-2.0
#include "common/coupling/messages.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "common/base/error.hpp"

namespace couplet {
namespace {

Command some_command() {
  Command c;
  c.op = Op::solve;
  c.step = {1.5, 0.25, Scheme::implicit, 7};
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
  r.interface.closed = true;
  r.interface.vertices = {{1, 2, 0}, {3, 4, 0}};
  r.interface.face_centres = {{2, 3, 0}};
  r.interface.face_areas = {{0, 1, 0}};
  r.interface.face_offset = {0, 2};
  r.interface.face_vertices = {1, 0};
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
  ASSERT_EQ(got.data.size(), 2u);
  EXPECT_EQ(got.data.at("displacement")[1], -2.5e-300);
  EXPECT_TRUE(std::isnan(got.data.at("displacement")[2]));
  EXPECT_TRUE(got.data.at("velocity").empty());
}

TEST(Messages, replies_arrive_as_they_were_sent) {
  const Reply sent = some_reply(), got = unpack_reply(pack(sent));
  EXPECT_EQ(got.status, sent.status);
  EXPECT_EQ(got.text, sent.text);
  EXPECT_EQ(got.seconds, sent.seconds);
  EXPECT_TRUE(std::isinf(got.suggested_dt));
  EXPECT_EQ(got.data, sent.data);
  EXPECT_EQ(got.interface.dim, 2);
  EXPECT_TRUE(got.interface.closed);
  EXPECT_EQ(got.interface.vertices, sent.interface.vertices);
  EXPECT_EQ(got.interface.face_centres, sent.interface.face_centres);
  EXPECT_EQ(got.interface.face_areas, sent.interface.face_areas);
  EXPECT_EQ(got.interface.face_offset, sent.interface.face_offset);
  EXPECT_EQ(got.interface.face_vertices, sent.interface.face_vertices);
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
  const std::vector<char> command = pack(some_command()), reply = pack(some_reply());
  for (std::size_t n = 0; n < command.size(); ++n)
    EXPECT_THROW(unpack_command({command.data(), n}), Error) << n << " of " << command.size() << " bytes";
  for (std::size_t n = 0; n < reply.size(); ++n)
    EXPECT_THROW(unpack_reply({reply.data(), n}), Error) << n << " of " << reply.size() << " bytes";
}

TEST(Messages, another_kind_or_version_is_refused) {
  std::vector<char> bytes = pack(some_reply());
  EXPECT_THROW(unpack_command(bytes), Error);
  bytes[8] = 99;  // the version follows the 8-byte mark
  try {
    unpack_reply(bytes);
    FAIL() << "accepted";
  } catch (const Error& error) {
    EXPECT_STREQ(
        error.what(),
        "A reply has protocol version 99, this program speaks version 3: use programs of one version.");
  }
}

}  // namespace
}  // namespace couplet
