// SPDX-License-Identifier: Apache-2.0
#include "socket_link.hpp"

#include <unistd.h>

#include <chrono>
#include <cstdlib>
#include <cstring>
#include <deque>
#include <map>
#include <thread>
#include <utility>

#include "stream.hpp"

namespace couplet::wire {
namespace {

class SocketLink : public Link {
 public:
  SocketLink(Stream stream, int ranks) : stream_(std::move(stream)), ranks_(ranks) {}

  int ranks() const override { return ranks_; }

  void send(int to, int tag, const std::vector<char>& bytes) override {
    stream_.write({to, tag, std::int64_t(bytes.size())}, bytes.data());
  }

  void send(int to, int tag, const std::vector<Stretch>& parts) override {
    Frame head{to, tag, 0};
    std::vector<iovec> all;
    for (const Stretch& part : parts) {
      all.push_back({part.first, part.count * sizeof(double)});
      head.size += std::int64_t(part.count * sizeof(double));
    }
    stream_.write(head, std::move(all));
  }

  std::vector<char> receive(int from, int tag) override {
    if (std::vector<char> kept; take(from, tag, kept)) return kept;
    std::vector<char> bytes(static_cast<std::size_t>(read_until(from, tag)));
    stream_.read(bytes.data(), bytes.size());
    return bytes;
  }

  bool receive(int from, int tag, const std::vector<Stretch>& parts) override {
    std::size_t wanted = 0;
    for (const Stretch& part : parts) wanted += part.count * sizeof(double);
    std::vector<char> kept;
    const bool was_kept = take(from, tag, kept);
    const std::size_t size = was_kept ? kept.size() : std::size_t(read_until(from, tag));
    if (size != wanted) return false;
    std::size_t at = 0;
    for (const Stretch& part : parts) {
      const std::size_t bytes = part.count * sizeof(double);
      if (was_kept)
        std::memcpy(part.first, kept.data() + at, bytes);
      else
        stream_.read(part.first, bytes);
      at += bytes;
    }
    return true;
  }

  void leave() override { stream_.write({0, leave_tag, 0}, ""); }

  void fail(const std::string& why) override {
    try {
      stream_.write({0, fail_tag, std::int64_t(why.size())}, why.data());
    } catch (const ConnectionLost&) {  // it ends either way
    }
  }

 private:
  bool take(int from, int tag, std::vector<char>& bytes) {
    auto& waiting = early_[{from, tag}];
    if (waiting.empty()) return false;
    bytes = std::move(waiting.front());
    waiting.pop_front();
    return true;
  }

  /// Length of the next message with this sender and tag. Earlier messages are stored.
  std::int64_t read_until(int from, int tag) {
    for (;;) {
      const Frame head = stream_.read_head();
      if (head.rank == from && head.tag == tag) return head.size;
      std::vector<char> bytes(static_cast<std::size_t>(head.size));
      stream_.read(bytes.data(), bytes.size());
      early_[{head.rank, head.tag}].push_back(std::move(bytes));
    }
  }

  Stream stream_;
  int ranks_;
  std::map<std::pair<int, int>, std::deque<std::vector<char>>> early_;
};

double seconds_to_wait() {
  const char* text = std::getenv("COUPLET_JOIN_WAIT");
  if (text == nullptr) return 60;
  char* end = nullptr;
  const double seconds = std::strtod(text, &end);
  if (end == text || *end != 0 || !(seconds > 0))
    throw std::runtime_error(std::string("COUPLET_JOIN_WAIT=") + text +
                             ": expected a number of seconds above 0.");
  return seconds;
}

Address await_address(const std::string& file) {
  const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(seconds_to_wait());
  while (::access(file.c_str(), F_OK) != 0) {
    if (std::chrono::steady_clock::now() > end)
      throw std::runtime_error(
          "COUPLET_JOIN: there is no '" + file +
          "' yet: no relay of the job has written it (COUPLET_JOIN_WAIT: seconds to wait, 60).");
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
  return Address::read(file);
}

}  // namespace

std::unique_ptr<Link> link_by_socket(const std::string& file, const std::string& participant, MPI_Comm comm) {
  Greeting greeting;
  MPI_Comm_rank(comm, &greeting.rank);
  MPI_Comm_size(comm, &greeting.size);
  const Address address = await_address(file);
  if (address.participant != participant)
    throw std::runtime_error("'" + file + "' belongs to the relay of '" + address.participant +
                             "'; this program is '" + participant + "'.");
  if (std::size_t(greeting.size) != address.places.size())
    throw std::runtime_error("'" + participant + "' has " + std::to_string(greeting.size) +
                             " processes, but its relay has " + std::to_string(address.places.size()) +
                             ": start the same number of both.");
  greeting.token = address.token;
  greeting.participant = participant;
  Stream stream = connect_to(address.places[std::size_t(greeting.rank)]);
  stream.write_line(greeting.line());
  // "welcome N" states the number of coupler ranks. Any other answer is the reason of a rejection.
  const std::string answer = stream.read_line(400, seconds_to_wait());
  if (answer.rfind("welcome ", 0) != 0)
    throw std::runtime_error("the relay of '" + participant + "' refused the connection" +
                             (answer.empty() ? "." : ": " + answer));
  return std::make_unique<SocketLink>(std::move(stream), std::atoi(answer.c_str() + 8));
}

}  // namespace couplet::wire
