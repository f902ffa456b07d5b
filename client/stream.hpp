// SPDX-License-Identifier: Apache-2.0
// Stream socket between a separately launched participant and its relay in the job.
#pragma once

#include <sys/types.h>
#include <sys/uio.h>

#include <cstdint>
#include <stdexcept>
#include <string>
#include <vector>

namespace couplet::wire {

/// Header of a message: rank of the coupler (sender or receiver), tag and length in bytes.
struct Frame {
  std::int32_t rank = 0, tag = 0;
  std::int64_t size = 0;
};
/// Tags of frames without a rank: the participant leaves regularly, or it ends with a reason in the message.
constexpr std::int32_t leave_tag = 1, fail_tag = 2;
constexpr std::int64_t longest_frame = std::int64_t(1) << 40;

struct ConnectionLost : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// Owns the descriptor. All calls throw ConnectionLost if the other side is gone.
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
  /// Also throws ConnectionLost for an invalid length.
  Frame read_head();
  void read(void* data, std::size_t size);
  /// Returns true if data arrived within `seconds`.
  bool readable(double seconds) const;
  /// Reads a line of at most `most` bytes without its end. Empty if there is none within `seconds`.
  std::string read_line(std::size_t most, double seconds);
  void write_line(const std::string& text);

 private:
  int descriptor_ = -1;
};

/// Address of a relay for its participant, in a file that only its owner can read.
struct Address {
  std::string participant, token;
  std::vector<std::string> places;  ///< by rank: "unix PATH" or "tcp HOST PORT"
  void write(const std::string& file) const;
  /// Throws std::runtime_error with the file and its problem.
  static Address read(const std::string& file);
};

/// First line that a participant sends.
struct Greeting {
  std::string token, participant;
  int rank = 0, size = 1;
  std::string line() const;
  /// Returns false if the text is not a greeting of this version.
  static bool parse(const std::string& line, Greeting& result);
};

/// Enlarges the buffers for a whole message as far as the system allows, so that both sides can write without
/// waiting. Call it before connect() or listen().
void widen(int socket);
/// Disables delayed sending and detects a lost network or machine within 5 s (RFC 1122 4.2.3.6, RFC 5482).
void watch(int tcp_socket);

/// Listens at `how`: "unix" or "tcp:INTERFACE[:PORT]". Sets `place`, the address for participants.
int listen_at(const std::string& how, std::string& place, std::string& folder);
/// Connects to an address. Throws std::runtime_error.
Stream connect_to(const std::string& place);

}  // namespace couplet::wire
