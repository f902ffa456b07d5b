// SPDX-License-Identifier: Apache-2.0
// Represents a separately launched participant in the job. Forwards messages between the coupler (MPI) and
// that program (a socket) without reading them (docs/protocol.md, "Launched separately").
#include <fcntl.h>
#include <poll.h>
#include <sys/random.h>
#include <sys/socket.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>

#include "client/stream.hpp"
#include "client/transports.hpp"
#include "client/wire.hpp"

namespace {

using namespace couplet::wire;

struct Options {
  std::string participant, listen = "unix", address;
  double wait = 600;
};

std::string name = "relay";               // for messages
std::string socket_folder, address_file;  // removed at the end

void tidy() {
  if (!socket_folder.empty()) {
    ::unlink((socket_folder + "/socket").c_str());
    ::rmdir(socket_folder.c_str());
    socket_folder.clear();
  }
  if (!address_file.empty()) ::unlink(address_file.c_str());
  address_file.clear();
}

extern "C" void stopped(int signal) {
  tidy();
  std::signal(signal, SIG_DFL);
  std::raise(signal);
}

[[noreturn]] void end_the_job(const std::string& text) {
  std::fprintf(stderr, "relay of '%s': %s\n", name.c_str(), text.c_str());
  std::fflush(nullptr);
  tidy();
  MPI_Abort(MPI_COMM_WORLD, 1);
  std::abort();
}

[[noreturn]] void usage(const std::string& problem) {
  if (!problem.empty()) std::fprintf(stderr, "relay: %s\n", problem.c_str());
  std::fprintf(
      problem.empty() ? stdout : stderr,
      "Usage: relay PARTICIPANT [--listen unix | tcp:INTERFACE[:PORT] | tcp6:INTERFACE[:PORT]] [--address FILE]\n"
      "             [--wait SECONDS]\n"
      "Stands in a job for a participant that is launched separately with COUPLET_JOIN=FILE in its environment.\n"
      "  --listen   how it is reached: a socket on this machine (unix, the default), or on one network interface (IPv4, IPv6)\n"
      "  --address  the file with its place and the token; default: PARTICIPANT.relay\n"
      "  --wait     seconds to wait for the participant; default: 600\n");
  std::exit(problem.empty() ? 0 : 2);
}

Options options_of(int argc, char** argv) {
  Options o;
  for (int i = 1; i < argc; ++i) {
    const std::string word = argv[i];
    const auto value = [&]() -> std::string {
      if (++i >= argc) usage("'" + word + "' needs a value.");
      return argv[i];
    };
    if (word == "--help" || word == "-h") usage("");
    if (word == "--listen")
      o.listen = value();
    else if (word == "--address")
      o.address = value();
    else if (word == "--wait") {
      char* end = nullptr;
      const std::string text = value();
      o.wait = std::strtod(text.c_str(), &end);
      if (*end != 0 || !(o.wait > 0)) usage("--wait " + text + ": expected a number of seconds above 0.");
    } else if (word.rfind("--", 0) == 0)
      usage("unknown option '" + word + "'.");
    else if (o.participant.empty())
      o.participant = word;
    else
      usage("one participant, not '" + o.participant + "' and '" + word + "'.");
  }
  if (o.participant.empty()) usage("the participant is missing.");
  if (o.address.empty()) o.address = o.participant + ".relay";
  return o;
}

std::string new_token() {
  unsigned char bytes[32];
  if (::getrandom(bytes, sizeof bytes, 0) != ssize_t(sizeof bytes))
    end_the_job("there are no random numbers.");
  std::string text;
  for (const unsigned char b : bytes) {
    char two[3];
    std::snprintf(two, sizeof two, "%02x", b);
    text += two;
  }
  return text;
}

/// Compares in a time that does not reveal how much of the token is correct.
bool same(const std::string& a, const std::string& b) {
  unsigned char different = a.size() != b.size();
  for (std::size_t i = 0; i < b.size(); ++i)
    different |= static_cast<unsigned char>(b[i] ^ (i < a.size() ? a[i] : ~b[i]));
  return !different;
}

/// Reason why a greeting is rejected, or empty.
std::string refusal(const std::string& line, const Address& address, int rank) {
  Greeting g;
  if (!Greeting::parse(line, g))
    return "this is not the greeting of version " + std::to_string(version) + " of the protocol.";
  if (!same(g.token, address.token)) return "the token is wrong.";
  if (g.participant != address.participant) return "this is the relay of '" + address.participant + "'.";
  if (g.rank != rank || std::size_t(g.size) != address.places.size())
    return "expected process " + std::to_string(rank) + " of " + std::to_string(address.places.size()) + ".";
  return "";
}

/// Accepts the connection of the participant and rejects others. The coupler's messages wait meanwhile.
Stream accept_participant(int listener, const Address& address, int rank, int coupler_ranks, double wait) {
  const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(wait);
  for (;;) {
    const std::chrono::duration<double> left = end - std::chrono::steady_clock::now();
    pollfd one{listener, POLLIN, 0};
    if (left.count() <= 0)
      end_the_job("nobody connected within " + std::to_string(int(wait)) + " s (--wait).");
    if (::poll(&one, 1, std::min(1000, int(1000 * left.count()) + 1)) <= 0) continue;
    Stream stream(::accept4(listener, nullptr, nullptr, SOCK_CLOEXEC));
    if (!stream.open()) continue;
    const std::string why = refusal(stream.read_line(400, 1), address, rank);
    try {
      if (why.empty()) {
        if (address.places[std::size_t(rank)].rfind("tcp", 0) == 0) watch(stream.descriptor());
        stream.write_line("welcome " + std::to_string(coupler_ranks));
        return stream;
      }
      std::fprintf(stderr, "relay of '%s': a connection was refused: %s\n", name.c_str(), why.c_str());
      stream.write_line(why);
    } catch (const ConnectionLost&) {  // it did not wait for the answer
    }
  }
}

/// Writes the file when all ranks listen. Collective.
Address publish(const Options& o, const std::string& place, MPI_Comm comm, int rank, int size) {
  Address address;
  address.participant = o.participant;
  char mine[200] = "", token[65] = "";
  std::strncpy(mine, place.c_str(), sizeof mine - 1);
  std::vector<char> all(sizeof mine * std::size_t(size));
  MPI_Allgather(mine, sizeof mine, MPI_CHAR, all.data(), sizeof mine, MPI_CHAR, comm);
  for (int r = 0; r < size; ++r) address.places.emplace_back(all.data() + sizeof mine * std::size_t(r));
  if (rank == 0) std::strncpy(token, new_token().c_str(), 64);
  MPI_Bcast(token, sizeof token, MPI_CHAR, 0, comm);
  address.token = token;
  if (rank == 0) {
    address.write(o.address);
    address_file = o.address;
    std::printf("relay of '%s': waiting; start it with COUPLET_JOIN=%s\n", name.c_str(), o.address.c_str());
    std::fflush(stdout);
  }
  return address;
}

/// Forwards one message from the coupler to the participant, if there is one.
bool pass_down(MPI_Comm coupler, Stream& stream, std::vector<char>& buffer) {
  Frame head;
  if (!receive_any(coupler, head.rank, head.tag, buffer)) return false;
  head.size = std::int64_t(buffer.size());
  stream.write(head, buffer.data());
  return true;
}

/// Forwards one message from the participant to the coupler. Returns false if the participant has left.
bool pass_up(MPI_Comm coupler, Stream& stream, std::vector<char>& buffer, int coupler_ranks) {
  const Frame head = stream.read_head();
  if (head.tag == leave_tag) return false;
  buffer.resize(std::size_t(head.size));
  stream.read(buffer.data(), buffer.size());
  if (head.tag == fail_tag)
    end_the_job("the participant ended: " + std::string(buffer.begin(), buffer.end()));
  if (head.rank < 0 || head.rank >= coupler_ranks || head.tag < join_tag || head.tag > output_tag)
    end_the_job("the participant sent a message that no program expects.");
  send(coupler, head.rank, head.tag, buffer, MPI_BYTE);
  return true;
}

void pass_on(MPI_Comm coupler, Stream& stream, int coupler_ranks) {
  std::vector<char> buffer;
  for (auto since = std::chrono::steady_clock::now();;) {
    bool busy = pass_down(coupler, stream, buffer);
    // Waits for both at once: on the socket, for the polling interval of a client that waits for MPI.
    const std::chrono::duration<double> waited = std::chrono::steady_clock::now() - since;
    const double nap = busy || waited.count() < 8e-5 ? 0 : std::min(waited.count() / 16, 2.5e-4);
    if (stream.readable(nap)) {
      if (!pass_up(coupler, stream, buffer, coupler_ranks)) return;
      busy = true;
    } else if (nap == 0) {
      sched_yield();
    }
    if (busy) since = std::chrono::steady_clock::now();
  }
}

int relay(const Options& o) {
  std::string place_text;
  const int listener = listen_at(o.listen, place_text, socket_folder);
  const Place place = join(o.participant, "relay");
  if (!place.starts) {
    tidy();
    MPI_Finalize();
    return 2;
  }
  int rank = 0, size = 0, coupler_ranks = 0;
  MPI_Comm_rank(place.comm, &rank);
  MPI_Comm_size(place.comm, &size);
  MPI_Comm_remote_size(place.coupler, &coupler_ranks);
  const Address address = publish(o, place_text, place.comm, rank, size);
  Stream stream = accept_participant(listener, address, rank, coupler_ranks, o.wait);
  ::close(listener);
  MPI_Request all;
  MPI_Ibarrier(place.comm, &all);  // the file exists until all participants are connected
  wait(all);
  tidy();
  pass_on(place.coupler, stream, coupler_ranks);
  MPI_Finalize();
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  const Options options = options_of(argc, argv);
  name = options.participant;
  std::signal(SIGTERM, stopped);
  std::signal(SIGINT, stopped);
  choose_transports();
  MPI_Init(nullptr, nullptr);
  try {
    return relay(options);
  } catch (const ConnectionLost& error) {
    end_the_job(std::string("the participant is lost (") + error.what() + ").");
  } catch (const std::exception& error) {
    end_the_job(error.what());
  }
}
