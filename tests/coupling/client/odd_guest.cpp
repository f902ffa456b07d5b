// SPDX-License-Identifier: Apache-2.0
// A guest that breaks the protocol in one way: odd_guest PARTICIPANT STAGE HOW [TOKEN]. It then stays, so that the others must end
// the job. odd_guests.py runs it.
#include <mpi.h>
#include <unistd.h>

#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <string>
#include <vector>

#include "client/wire.hpp"

using namespace couplet::wire;

namespace {

[[noreturn]] void stay() {
  ::sleep(120);
  std::_Exit(0);
}

/// Four integers as a program of another version, or of another world, says them.
void greet(std::int64_t mark, std::int64_t number) {
  const std::int64_t hello[4] = {mark, number, 1, 0};
  int size = 0;
  MPI_Comm_size(MPI_COMM_WORLD, &size);
  std::vector<std::int64_t> all(4 * std::size_t(size));
  MPI_Request request;
  MPI_Iallgather(hello, 4, MPI_INT64_T, all.data(), 4, MPI_INT64_T, MPI_COMM_WORLD, &request);
  wait(request);
}

void introduce(const std::string& text) {
  int rank = 0, size = 0;
  MPI_Comm_rank(MPI_COMM_WORLD, &rank);
  MPI_Comm_size(MPI_COMM_WORLD, &size);
  MPI_Comm nobody;
  MPI_Comm_split(MPI_COMM_WORLD, MPI_UNDEFINED, rank, &nobody);
  std::vector<int> counts(static_cast<std::size_t>(size)), first;
  const int length = int(text.size());
  MPI_Allgather(&length, 1, MPI_INT, counts.data(), 1, MPI_INT, MPI_COMM_WORLD);
  int total = 0;
  for (const int n : counts) first.push_back(total), total += n;
  std::string all(std::size_t(total), '\0');
  MPI_Allgatherv(text.data(), length, MPI_BYTE, all.data(), counts.data(), first.data(), MPI_BYTE,
                 MPI_COMM_WORLD);
}

Surface strip() {
  Surface s;
  s.dim = 2;
  s.xyz = {0, 0, 0, 1, 0, 0, 2, 0, 0};
  s.centres = {0.5, 0, 0, 1.5, 0, 0};
  s.areas = {0, 1, 0, 0, 1, 0};
  s.first = {0, 2, 4};
  s.corners = {0, 1, 1, 2};
  return s;
}

/// The reply to initialise of a participant that takes forces and gives a displacement.
std::vector<char> head(const std::string& how) {
  Packer out;
  out.integers(
      {how == "mark" ? 77 : reply_mark, how == "version" ? version + 1 : version, how == "status" ? 9 : 0});
  out.text("");
  for (const double value : {0., 1e9, 0.}) out.real(value);
  out.integers({0});
  out.real(NAN), out.real(NAN), out.real(NAN);
  out.integers({0, how == "dimension" ? 4 : 2, 0});
  const std::string name = how == "name" ? std::string(100000, 'x') : "pressure-force";
  std::vector<Datum> takes{{name, "N", COUPLET_FACES, 0}};
  if (how == "twice") takes.push_back(takes.front());
  out.data(takes);
  out.data({{"displacement", "m", COUPLET_VERTICES, 0}});
  const std::int64_t n = how == "huge" ? std::int64_t(1) << 40 : 3;
  out.list(how == "ranks"   ? std::vector<std::int64_t>{0, 1, 3}
           : how == "falls" ? std::vector<std::int64_t>{0, -3}
                            : std::vector<std::int64_t>{0, n});
  out.list({0, 2});
  std::vector<char> bytes = out.bytes();
  if (how == "cut") bytes.resize(bytes.size() / 2);
  if (how == "long") bytes.resize(std::size_t(80) << 20);
  return bytes;
}

[[noreturn]] void answer(const Place& place, const std::string& how) {
  receive<char>(place.coupler, 0, command_tag, MPI_BYTE);
  send(place.coupler, 0, reply_tag, head(how), MPI_BYTE);
  Surface s = strip();
  if (how == "corner") s.corners[3] = 77;
  if (how == "nowhere") s.xyz[4] = NAN;
  Peer all{0, 0, 3, 0, 2};
  if (how == "fewer") all.vertices = 2;
  send(place.coupler, 0, places_tag, s.cut_out(all), MPI_BYTE);
  stay();
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 4) return 64;
  const std::string participant = argv[1], stage = argv[2], how = argv[3];
  MPI_Init(&argc, &argv);
  if (stage == "handshake") {
    greet(how == "mark" ? 42 : hello_mark, how == "mark" ? version : std::atoi(how.c_str()));
    stay();
  }
  if (stage == "introduction") {
    greet(hello_mark, version);
    introduce(how == "nothing" ? "\x1e"
              : how == "words" ? "a\x1f"
                                 "b\x1f"
                                 "c\x1fhash\x1f\x1f"
                                 "1\x1fnumber\x1frank\x1f\x1f\x1e"
                               : std::string(3, '\x1e'));
    stay();
  }
  const Place place = join(participant, "odd_guest");
  if (!place.starts) return 2;
  answer(place, how);
}
