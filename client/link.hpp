// SPDX-License-Identifier: Apache-2.0
// Connection from one process of a participant to the ranks of the coupler, private to the client library.
#pragma once

#include <mpi.h>

#include <cstddef>
#include <memory>
#include <string>
#include <vector>

namespace couplet::wire {

/// Part of an array. Several are sent as one message without being copied together.
struct Stretch {
  double* first;
  std::size_t count;
};

/// Tagged messages, ordered for each sender and tag. Throws std::runtime_error if the connection is lost.
class Link {
 public:
  virtual ~Link() = default;
  /// Number of ranks of the coupler.
  virtual int ranks() const = 0;
  virtual void send(int to, int tag, const std::vector<char>& bytes) = 0;
  virtual void send(int to, int tag, const std::vector<Stretch>& parts) = 0;
  virtual std::vector<char> receive(int from, int tag) = 0;
  /// Returns false if a message of another length arrived.
  virtual bool receive(int from, int tag, const std::vector<Stretch>& parts) = 0;
  /// Tells the other side that the job is over for this process.
  virtual void leave() {}
  /// Tells the other side why this process ends.
  virtual void fail(const std::string& why) { static_cast<void>(why); }
};

/// Link over an intercommunicator, if one mpirun started all programs.
std::unique_ptr<Link> link_by_mpi(MPI_Comm coupler);

}  // namespace couplet::wire
