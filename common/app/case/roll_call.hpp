// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <mpi.h>

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "common/base/error.hpp"

namespace couplet::app {

/// What one process says of itself at the roll call.
struct Attendant {
  std::string program;        ///< "solid_solver"
  std::string participant;    ///< its name in the YAML; empty if it could not be found
  std::string case_file;      ///< as given on the command line
  std::size_t case_hash = 0;  ///< of the YAML's text after overrides
  std::string restart;        ///< --restart, empty without
  bool named = false;         ///< --participant was given
  int application = 0;        ///< number of its part of the mpirun line (MPI_APPNUM)
  int world_rank = 0;
  std::string process;              ///< "PID@MACHINE"; empty: not told
  std::vector<std::string> errors;  ///< in its own part of the configuration
};

/// One participant as the YAML has it.
struct Expected {
  std::string participant, program;
};

/// One participant as it has come.
struct Member {
  std::string participant, program;
  int first_rank = 0, ranks = 0;  ///< in MPI_COMM_WORLD
};

struct Verdict {
  std::string problem;  ///< empty: the job can start
  bool alone = false;   ///< only one participant has come and shall run without the others
};

inline constexpr const char* coupler_name = "coupler";

/// A handshake that failed. `speaker`: the first process of this project and version, which says so for all.
class HandshakeFailure final : public Error {
 public:
  HandshakeFailure(const std::string& text, int speaker) : Error(text), speaker(speaker) {}
  int speaker;
};

/// The very first words of a job: every process says in four 64-bit integers that it is part of it (mark,
/// version of the protocol, 0 for a program of this project or 1 for a guest, 0; docs/protocol.md). Returns
/// the communicator of this project's processes, who watch over each other; guests are not in it. Waits
/// without burning a core and says for what. Throws HandshakeFailure if a process says something else. Collective over
/// `world`.
MPI_Comm shake_hands(MPI_Comm world);

/// What all processes said at the handshake, four integers each: throws HandshakeFailure.
void check_hands(std::span<const std::int64_t> all);

/// What a process has said of itself, without the end of text; throws Error if it is not what docs/protocol.md asks for.
Attendant introduced(const std::string& text, int process);

/// Every process's answer, by world rank, on every process. Collective.
std::vector<Attendant> roll_call(MPI_Comm world, const Attendant& self);

/// Compares who has come with who is expected. `coupled`: the YAML has a `coupling` section (the coupler is
/// then expected too, and is part of `expected`). The same on every process.
Verdict judge(const std::vector<Attendant>& attendants, const std::vector<Expected>& expected, bool coupled);

/// Whether nobody has seen a problem: then the job starts. Collective over `world`.
bool all_agree_to_start(MPI_Comm world, bool problem);

/// In order of first world rank.
std::vector<Member> members(const std::vector<Attendant>& attendants);

}  // namespace couplet::app
