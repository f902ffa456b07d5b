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

/// Data of one process at the roll call.
struct Attendant {
  std::string program;        ///< "solid_solver"
  std::string participant;    ///< its name in the YAML; empty if it was not found
  std::string case_file;      ///< as given on the command line
  std::size_t case_hash = 0;  ///< of the YAML text with overrides
  std::string restart;        ///< folder of --restart, or empty
  bool named = false;         ///< --participant was given
  int application = 0;        ///< index of its part of the mpirun command (MPI_APPNUM)
  int world_rank = 0;
  std::string process;              ///< "PID@MACHINE"; empty if unknown
  std::vector<std::string> errors;  ///< in its own part of the configuration
};

/// Participant as declared in the YAML.
struct Expected {
  std::string participant, program;
};

/// Participant as found in the job.
struct JobMember {
  std::string participant, program;
  int first_rank = 0, ranks = 0;  ///< in MPI_COMM_WORLD
};

struct Attendance {
  std::string problem;  ///< empty if the job can start
  bool alone = false;   ///< only one participant is present and runs without the others
};

inline constexpr const char* coupler_name = "coupler";

/// Failed handshake. `speaker` is the first process of this project and version, which reports it for all.
class HandshakeFailure final : public Error {
 public:
  HandshakeFailure(const std::string& text, int speaker) : Error(text), speaker(speaker) {}
  int speaker;
};

/// Performs the handshake: every process sends four 64-bit integers (mark, protocol version, 0 for a program
/// of this project or 1 for a guest, 0; docs/protocol.md). Returns the communicator of this project's
/// processes, which watch each other; guests are excluded. Waits without busy polling and logs for whom.
/// Throws HandshakeFailure for any other message. Collective over `world`.
MPI_Comm shake_hands(MPI_Comm world);

/// Checks the handshake messages of all processes, four integers each. Throws HandshakeFailure.
void check_hands(std::span<const std::int64_t> all);

/// Parses the roll-call answer of a process, without its terminator. Throws Error if it violates
/// docs/protocol.md.
Attendant introduced(const std::string& text, int process);

/// Exchanges the answers of all processes, sorted by world rank. Collective.
std::vector<Attendant> roll_call(MPI_Comm world, const Attendant& self);

/// Compares the processes with the expected participants. `coupled` means that the YAML has a `coupling`
/// section; the coupler is then part of `expected`. The result is the same on every process.
Attendance attendance_of(const std::vector<Attendant>& attendants, const std::vector<Expected>& expected,
                         bool coupled);

/// Returns true if no process has a problem, so that the job starts. Collective over `world`.
bool all_agree_to_start(MPI_Comm world, bool problem);

/// Participants in order of their first world rank.
std::vector<JobMember> members(const std::vector<Attendant>& attendants);

}  // namespace couplet::app
