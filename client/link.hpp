// SPDX-License-Identifier: Apache-2.0
// The way from one process of a participant to the ranks of the coupler; private to the client library.
#pragma once

#include <mpi.h>

#include <cstddef>
#include <memory>
#include <string>
#include <vector>

namespace couplet::wire {

/// Part of an array. Several travel as one message, one after the other, without being copied together.
struct Stretch {
  double* first;
  std::size_t count;
};

/// Messages with a tag; those of one sender and one tag arrive in their order. Throws std::runtime_error where the
/// way is lost.
class Link {
 public:
  virtual ~Link() = default;
  /// Of the coupler.
  virtual int ranks() const = 0;
  virtual void send(int to, int tag, const std::vector<char>& bytes) = 0;
  virtual void send(int to, int tag, const std::vector<Stretch>& parts) = 0;
  virtual std::vector<char> receive(int from, int tag) = 0;
  /// False if a message of another length came.
  virtual bool receive(int from, int tag, const std::vector<Stretch>& parts) = 0;
  /// The job is over for this process.
  virtual void leave() {}
  /// The other side learns why this process ends.
  virtual void fail(const std::string& why) { static_cast<void>(why); }
};

/// Over an intercommunicator: all programs were started by one mpirun.
std::unique_ptr<Link> link_by_mpi(MPI_Comm coupler);

}  // namespace couplet::wire
