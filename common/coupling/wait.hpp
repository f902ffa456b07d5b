// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <mpi.h>

#include <chrono>
#include <ctime>
#include <span>
#include <string>
#include <vector>

namespace couplet::coupling {

/// Waiting that yields the core, because programs of a coupled job take turns and MPI's blocking calls spin.
/// It spins for 80 us, since messages between programs are short. Then it sleeps for 1/16 of the time already
/// waited, at most 0.25 ms, because delays of consecutive waits add up in small jobs. It logs the awaited
/// program after 30 s, and each time the wait has doubled.
class PoliteWait {
 public:
  /// `what` completes "waiting for ..."; nothing is logged if it is empty.
  explicit PoliteWait(std::string what) : what_(std::move(what)) {}
  PoliteWait(const PoliteWait&) = delete;
  PoliteWait& operator=(const PoliteWait&) = delete;
  ~PoliteWait();
  /// Pauses between two polls.
  void pause();

 private:
  using Clock = std::chrono::steady_clock;
  std::string what_;
  Clock::time_point start_ = Clock::now();
  std::chrono::duration<double> notice_{30}, report_{1};
  bool reported_ = false;
};

/// Observer of long waits (the watch over the job), one per process. It is called four times per second after
/// the first second of a wait, and at its end.
struct WaitObserver {
  void (*lasts)(const char* what) = nullptr;
  void (*over)() = nullptr;
};
void observe_waits(const WaitObserver& observer);

void wait_politely(MPI_Request& request, const std::string& what);

/// Processor time of this process [s].
inline double processor_seconds() { return double(std::clock()) / CLOCKS_PER_SEC; }

/// Sends one message of any length. `peers` may be an intercommunicator.
void send_bytes(MPI_Comm peers, int to, int tag, std::span<const char> bytes, const std::string& what);
/// Limit on the length of heads. receive_bytes() throws Error for more than `most` bytes.
inline constexpr std::size_t longest_head = std::size_t(64) << 20;
std::vector<char> receive_bytes(MPI_Comm peers, int from, int tag, const std::string& what,
                                std::size_t most = std::size_t(2) << 30);

/// Segments of arrays that are received as one message without being copied together. Throws Error for a
/// message of another length.
using Stretches = std::vector<std::span<double>>;
void receive_stretches(MPI_Comm peers, int from, int tag, const Stretches& to, const std::string& what);

/// Sends several messages concurrently. The values must not move until wait() returns.
class SendAll {
 public:
  explicit SendAll(MPI_Comm peers) : peers_(peers) {}
  void add(int to, int tag, const std::vector<std::span<const double>>& values);
  void wait(const std::string& what);

 private:
  MPI_Comm peers_;
  std::vector<MPI_Request> requests_;
};

/// Broadcasts rank 0's bytes; the others wait politely. Collective.
void broadcast_bytes(MPI_Comm comm, std::vector<char>& bytes, const std::string& what);

}  // namespace couplet::coupling
