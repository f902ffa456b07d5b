// SPDX-License-Identifier: Apache-2.0
// A connected stream socket between a participant that was started by itself and its relay in the job.
#pragma once

#include <sys/types.h>
#include <sys/uio.h>

#include <cstdint>
#include <stdexcept>
#include <string>
#include <vector>

namespace couplet::wire {

/// Before each message: a rank of the coupler (to or from which it travels), its tag, its length in bytes.
struct Frame {
  std::int32_t rank = 0, tag = 0;
  std::int64_t size = 0;
};
/// Frames without a rank: the participant leaves in good order; it ends, and the message says why.
constexpr std::int32_t leave_tag = 1, fail_tag = 2;
constexpr std::int64_t longest_frame = std::int64_t(1) << 40;

struct ConnectionLost : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// Owns the descriptor. All calls throw ConnectionLost when the other side is gone.
class Stream {
 public:
  Stream() = default;
  explicit Stream(int descriptor) : descriptor_(descriptor) {}
  Stream(Stream&& other) noexcept : descriptor_(other.descriptor_) { other.descriptor_ = -1; }
  Stream& operator=(Stream&& other) noexcept;
  ~Stream() { close(); }
  void close();
  bool open() const { return descriptor_ >= 0; }
  int descriptor() const { return descriptor_; }

  void write(const Frame& head, std::vector<iovec> parts);
  void write(const Frame& head, const void* data) {
    write(head, {{const_cast<void*>(data), std::size_t(head.size)}});
  }
  /// Throws ConnectionLost for a length that cannot be, too.
  Frame read_head();
  void read(void* data, std::size_t size);
  /// Whether something has come within these seconds.
  bool readable(double seconds) const;
  /// At most `most` bytes up to a line's end, which is taken away; an empty string if there is none within `seconds`.
  std::string read_line(std::size_t most, double seconds);
  void write_line(const std::string& text);

 private:
  int descriptor_ = -1;
};

/// Where a relay waits for its participant: a file that the relay writes, readable by its owner alone.
struct Address {
  std::string participant, token;
  std::vector<std::string> places;  ///< by rank: "unix PATH" or "tcp HOST PORT"
  void write(const std::string& file) const;
  /// Throws std::runtime_error naming the file and what is wrong.
  static Address read(const std::string& file);
};

/// The line that a participant sends first.
struct Greeting {
  std::string token, participant;
  int rank = 0, size = 1;
  std::string line() const;
  /// False if the text is no greeting of this version.
  static bool parse(const std::string& line, Greeting& result);
};

/// Room for a whole message on its way, as far as the system allows: both sides write without waiting for each other.
/// Before connect() or listen().
void widen(int socket);
/// Detects a network or a machine that is gone within 5 s (RFC 1122 4.2.3.6, RFC 5482); sends at once.
void watch(int tcp_socket);

/// Listens where `how` says: "unix" or "tcp:INTERFACE[:PORT]". `place`: what participants need to find it.
int listen_at(const std::string& how, std::string& place, std::string& folder);
/// Throws std::runtime_error.
Stream connect_to(const std::string& place);

}  // namespace couplet::wire
