// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <mpi.h>

#include <chrono>
#include <ctime>
#include <span>
#include <string>
#include <vector>

namespace couplet::coupling {

/// Waiting that leaves the core to others: the programs of a coupled job take turns, and MPI's own blocking
/// calls spin. Spins for the first 80 us (messages between programs are short), then sleeps for a
/// sixteenth of the time already waited, 0.25 ms at most: a step of a small job has a score of waits, one behind the
/// other, and each ends half a sleep late. Says for whom and since when after 30 s, and again each time the
/// wait has doubled.
class PoliteWait {
 public:
  /// `what` completes "waiting for ..."; empty: never says anything.
  explicit PoliteWait(std::string what) : what_(std::move(what)) {}
  PoliteWait(const PoliteWait&) = delete;
  PoliteWait& operator=(const PoliteWait&) = delete;
  ~PoliteWait();
  /// Between two looks at whatever is awaited.
  void pause();

 private:
  using Clock = std::chrono::steady_clock;
  std::string what_;
  Clock::time_point start_ = Clock::now();
  std::chrono::duration<double> notice_{30}, report_{1};
  bool reported_ = false;
};

/// Who hears of waits that last (the watch over the job), one a process: four times a second from the second second of
/// a wait on, and when it is over.
struct WaitObserver {
  void (*lasts)(const char* what) = nullptr;
  void (*over)() = nullptr;
};
void observe_waits(const WaitObserver& observer);

void wait_politely(MPI_Request& request, const std::string& what);

/// Of this process so far, in seconds; what others do on the machine is not in it.
inline double processor_seconds() { return double(std::clock()) / CLOCKS_PER_SEC; }

/// One message of any length. `peers` may be an intercommunicator.
void send_bytes(MPI_Comm peers, int to, int tag, std::span<const char> bytes, const std::string& what);
/// Throws Error if more than `most` bytes come.
inline constexpr std::size_t longest_head = std::size_t(64) << 20;
std::vector<char> receive_bytes(MPI_Comm peers, int from, int tag, const std::string& what,
                                std::size_t most = std::size_t(2) << 30);

/// Some stretches of arrays that travel as one message, one after the other, without being copied together.
/// Throws Error if a message of another length comes.
using Stretches = std::vector<std::span<double>>;
void receive_stretches(MPI_Comm peers, int from, int tag, const Stretches& to, const std::string& what);

/// Several messages on their way at once; the values must stay where they are until wait().
class SendAll {
 public:
  explicit SendAll(MPI_Comm peers) : peers_(peers) {}
  void add(int to, int tag, const std::vector<std::span<const double>>& values);
  void wait(const std::string& what);

 private:
  MPI_Comm peers_;
  std::vector<MPI_Request> requests_;
};

/// Rank 0's bytes to all ranks; the others wait politely. Collective.
void broadcast_bytes(MPI_Comm comm, std::vector<char>& bytes, const std::string& what);

}  // namespace couplet::coupling
