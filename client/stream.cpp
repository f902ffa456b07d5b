// SPDX-License-Identifier: Apache-2.0
#include "stream.hpp"

#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <climits>
#include <cmath>
#include <cstring>

namespace couplet::wire {
namespace {

[[noreturn]] void lost(const char* what) {
  throw ConnectionLost(std::string(what) +
                       (errno ? std::string(": ") + std::strerror(errno) : std::string()));
}

}  // namespace

Stream& Stream::operator=(Stream&& other) noexcept {
  if (this != &other) {
    close();
    descriptor_ = other.descriptor_;
    other.descriptor_ = -1;
  }
  return *this;
}

void Stream::close() {
  if (descriptor_ >= 0) ::close(descriptor_);
  descriptor_ = -1;
}

void Stream::write(const Frame& head, std::vector<iovec> parts) {
  parts.insert(parts.begin(), iovec{const_cast<Frame*>(&head), sizeof head});
  for (std::size_t first = 0; first < parts.size();) {
    if (parts[first].iov_len == 0) {
      ++first;
      continue;
    }
    msghdr message{};
    message.msg_iov = parts.data() + first;
    message.msg_iovlen = std::min<std::size_t>(parts.size() - first, IOV_MAX);
    const ssize_t n = ::sendmsg(descriptor_, &message, MSG_NOSIGNAL);
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) lost("sending failed");
    for (auto left = std::size_t(n); left > 0;) {
      const std::size_t taken = std::min(left, parts[first].iov_len);
      parts[first].iov_base = static_cast<char*>(parts[first].iov_base) + taken;
      parts[first].iov_len -= taken;
      left -= taken;
      if (parts[first].iov_len == 0) ++first;
    }
  }
}

void Stream::read(void* data, std::size_t size) {
  char* to = static_cast<char*>(data);
  while (size > 0) {
    const ssize_t n = ::recv(descriptor_, to, size, 0);
    if (n < 0 && errno == EINTR) continue;
    if (n == 0) errno = 0;
    if (n <= 0) lost("the connection was closed");
    to += n;
    size -= std::size_t(n);
  }
}

Frame Stream::read_head() {
  Frame head;
  read(&head, sizeof head);
  if (head.size < 0 || head.size > longest_frame) throw ConnectionLost("a message has an impossible length");
  return head;
}

bool Stream::readable(double seconds) const {
  pollfd one{descriptor_, POLLIN, 0};
  const timespec limit{time_t(seconds), long((seconds - std::floor(seconds)) * 1e9)};
  return ::ppoll(&one, 1, &limit, nullptr) > 0;
}

std::string Stream::read_line(std::size_t most, double seconds) {
  const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(seconds);
  std::string line;
  while (line.size() < most) {
    const std::chrono::duration<double> left = end - std::chrono::steady_clock::now();
    char c = 0;
    if (left.count() <= 0 || !readable(left.count()) || ::recv(descriptor_, &c, 1, 0) != 1) return "";
    if (c == '\n') return line;
    line += c;
  }
  return "";
}

void Stream::write_line(const std::string& text) {
  const std::string line = text + '\n';
  if (::send(descriptor_, line.data(), line.size(), MSG_NOSIGNAL) != ssize_t(line.size()))
    lost("sending failed");
}

void widen(int socket) {
  const int bytes = 4 << 20;
  ::setsockopt(socket, SOL_SOCKET, SO_SNDBUF, &bytes, sizeof bytes);
  ::setsockopt(socket, SOL_SOCKET, SO_RCVBUF, &bytes, sizeof bytes);
}

void watch(int tcp_socket) {
  const int on = 1, idle = 2, every = 1, most = 3;
  const unsigned unanswered = 5000;  // ms
  ::setsockopt(tcp_socket, SOL_SOCKET, SO_KEEPALIVE, &on, sizeof on);
  ::setsockopt(tcp_socket, IPPROTO_TCP, TCP_KEEPIDLE, &idle, sizeof idle);
  ::setsockopt(tcp_socket, IPPROTO_TCP, TCP_KEEPINTVL, &every, sizeof every);
  ::setsockopt(tcp_socket, IPPROTO_TCP, TCP_KEEPCNT, &most, sizeof most);
  ::setsockopt(tcp_socket, IPPROTO_TCP, TCP_USER_TIMEOUT, &unanswered, sizeof unanswered);
  ::setsockopt(tcp_socket, IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
}

}  // namespace couplet::wire
