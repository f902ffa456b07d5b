// SPDX-License-Identifier: Apache-2.0
// Bytes of a guest: handshake, roll call, replies, places, and commands as a client gets them. Refused, or read as
// something sound. See README.md.
#include <new>

#include "client/wire.hpp"
#include "common/app/case/roll_call.hpp"
#include "common/coupling/messages.hpp"
#include "tests/fuzz/mutate.hpp"

namespace couplet::fuzz::messages_fuzz {
using namespace coupling;

std::string text_of(const std::vector<char>& bytes) { return {bytes.begin(), bytes.end()}; }

Command command() {
  Command c;
  c.op = Op::solve;
  c.step = {1.5, 0.25, Scheme::implicit, 7};
  c.data = {{"displacement", {}}, {"velocity", {}}};
  c.folder = "out/checkpoints/step-00000001";
  return c;
}

Reply reply() {
  Reply r;
  r.text = "cell 12 is inverted";
  r.data = {{"pressure-force", {}}};
  r.interface.dim = 2;
  r.interface.takes = {{"displacement", "m", Interface::Place::vertices}};
  r.interface.gives = {{"pressure-force", "N", Interface::Place::faces},
                       {"heat", "W", Interface::Place::faces, 1}};
  return r;
}

Interface surface() {
  Interface i;
  i.vertices = {{0, 0, 0}, {1, 0, 0}, {2, 1, 0}};
  i.face_centres = {{0.5, 0, 0}, {1.5, 0.5, 0}};
  i.face_areas = {{0, 1, 0}, {-1, 1, 0}};
  i.face_offset = {0, 2, 4};
  i.face_vertices = {0, 1, 1, 2};
  return i;
}

/// Words of 8 bytes replaced by what a length, a mark or a version could be made to be; or bytes anywhere.
std::string spoil(std::string bytes, Dice& dice) {
  static const std::vector<std::int64_t> odd{-1,
                                             0,
                                             1,
                                             2,
                                             3,
                                             5,
                                             7,
                                             255,
                                             1 << 20,
                                             std::int64_t(1) << 31,
                                             std::int64_t(1) << 40,
                                             std::numeric_limits<std::int64_t>::max(),
                                             std::numeric_limits<std::int64_t>::min()};
  if (dice.one_in(3)) return mutate_bytes(std::move(bytes), dice);
  for (std::size_t n = 1 + dice.below(3); n > 0 && bytes.size() >= 8; --n) {
    // Texts move what follows off the grid of 8 bytes.
    std::size_t at = dice.below(bytes.size() - 7);
    if (!dice.one_in(4)) at -= at % 8;
    std::int64_t value = dice.of(odd);
    if (dice.one_in(3)) {
      std::memcpy(&value, &bytes[at], 8);
      value += dice.one_in(2) ? 1 : -1;
    }
    std::memcpy(&bytes[at], &value, 8);
  }
  return bytes;
}

void expect_name(const std::string& name) {
  ASSERT_LE(name.size(), 256u);
  for (const unsigned char c : name) ASSERT_GE(c, 32);
}

void read_command(const std::string& bytes) {
  const Command c = unpack_command(bytes);
  ASSERT_STRNE(name(c.op), "unknown command");
  ASSERT_GE(c.step.sub_steps, 1);
  for (const auto& [name, values] : c.data) expect_name(name);
}

void read_reply(const std::string& bytes) {
  Partition cut;
  const Reply r = unpack_reply(bytes, cut);
  ASSERT_TRUE(r.interface.dim == 2 || r.interface.dim == 3);
  for (const auto* list : {&r.interface.takes, &r.interface.gives})
    for (const Interface::Datum& datum : *list) {
      expect_name(datum.name);
      ASSERT_TRUE(datum.size(r.interface.dim) > 0 && datum.size(r.interface.dim) < 10);
    }
  for (const Starts* starts : {&cut.vertices, &cut.faces}) {
    ASSERT_FALSE(starts->empty());
    ASSERT_EQ(starts->front(), 0);
    ASSERT_TRUE(std::is_sorted(starts->begin(), starts->end()));
    ASSERT_LE(starts->back(), std::numeric_limits<Index>::max());
  }
}

void read_places(const std::string& bytes) {
  Interface i;
  std::vector<int> surfaces;
  put_back(bytes, i, surfaces);
  ASSERT_EQ(i.face_offset.size(), i.face_centres.size() + 1);
  ASSERT_EQ(std::size_t(i.face_offset.back()), i.face_vertices.size());
  for (const Vec3& x : i.vertices) ASSERT_TRUE(x.allFinite());
}

void read_introduction(const std::string& bytes) {
  const app::Attendant a = app::introduced(bytes, 3);
  ASSERT_EQ(a.world_rank, 3);
  expect_name(a.participant);
}

void read_hands(const std::string& bytes) {
  std::vector<std::int64_t> all(4 * (bytes.size() / 32));
  std::memcpy(all.data(), bytes.data(), all.size() * 8);
  app::check_hands(all);
}

/// What the client library says of a command, as Error.
void read_as_client(const std::string& bytes) {
  try {
    const wire::Command c = wire::unpack({bytes.begin(), bytes.end()});
    ASSERT_TRUE(c.op >= 1 && c.op <= 8);
  } catch (const std::runtime_error& error) {
    throw Error(std::string(error.what()));
  }
}

struct Kind {
  const char* name;
  std::string right;
  std::function<void(const std::string&)> read;
};

std::vector<Kind> kinds() {
  const std::int64_t mark = 0x434f55504c4554,
                     hands[8] = {mark, protocol_version, 0, 0, mark, protocol_version, 1, 0};
  const std::string separator(1, '\x1f');
  std::string introduction;
  for (const char* field : {"my_solver", "solid", "(guest)", "0", "", "1", "2", "3", "7@machine"})
    introduction += field + separator;
  return {{"command", text_of(pack(command())), read_command},
          {"command to a client", text_of(pack(command())), read_as_client},
          {"reply", text_of(pack(reply(), {{0, 5, 7}, {0, 0, 9}})), read_reply},
          {"places", text_of(cut_out(surface(), {0, 3, 0, 2})), read_places},
          {"introduction", introduction, read_introduction},
          {"handshake", {reinterpret_cast<const char*>(hands), sizeof hands}, read_hands}};
}

TEST(GuestsBytes, are_refused_or_sound) {
  Dice dice(seed());
  const std::vector<Kind> all = kinds();
  for (const Kind& kind : all) ASSERT_NO_THROW(kind.read(kind.right)) << kind.name;
  std::size_t refused = 0;
  double slowest = 0;
  for (std::size_t i = 0; i < count(); ++i) {
    const Kind& kind = dice.of(all);
    const std::string bytes = spoil(kind.right, dice);
    const auto start = std::chrono::steady_clock::now();
    try {
      kind.read(bytes);
    } catch (const Error& error) {
      ++refused;
      EXPECT_GT(std::string(error.what()).size(), 20u) << kind.name;
    } catch (const std::exception& error) {
      ADD_FAILURE() << kind.name << ", case " << i << ": " << error.what();
    }
    const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - start;
    slowest = std::max(slowest, seconds.count());
    if (HasFailure()) break;
  }
  EXPECT_LT(slowest, double(longest()));
  EXPECT_LT(peak_memory(), 1000);
  EXPECT_GT(refused, count() / 3);
  RecordProperty("tried", int(count()));
  RecordProperty("refused", int(refused));
  RecordProperty("slowest", fmt::format("{:.3f}", slowest));
  RecordProperty("megabytes", fmt::format("{:.0f}", peak_memory()));
}

TEST(GuestsBytes, another_version_names_both) {
  const std::int64_t mark = 0x434f55504c4554;
  for (const std::int64_t version :
       {protocol_version - 1, protocol_version + 1, std::int64_t(0), std::int64_t(-7)}) {
    const std::vector<std::int64_t> hands{mark, version, 1, 0, mark, protocol_version, 0, 0};
    try {
      app::check_hands(hands);
      FAIL() << "accepted";
    } catch (const app::HandshakeFailure& failure) {
      const std::string text = failure.what();
      EXPECT_NE(
          text.find(fmt::format("Process 0 of the job (an external program) uses version {} ", version)),
          std::string::npos)
          << text;
      EXPECT_NE(text.find(fmt::format("here use version {}", protocol_version)), std::string::npos) << text;
      EXPECT_EQ(failure.speaker, 1);
    }
  }
}

}  // namespace couplet::fuzz::messages_fuzz
