// SPDX-License-Identifier: Apache-2.0
// Connection of a relay and its participant: the file with address and token, the greeting, the sockets.
#include <arpa/inet.h>
#include <fcntl.h>
#include <ifaddrs.h>
#include <netdb.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <sstream>

#include "stream.hpp"
#include "wire.hpp"

namespace couplet::wire {
namespace {

constexpr const char* file_mark = "couplet relay 1";
constexpr const char* greeting_mark = "couplet-join";

[[noreturn]] void refuse(const std::string& text) { throw std::runtime_error(text); }

template <class T>
bool whole(const std::string& word, T& value) {
  const auto [end, code] = std::from_chars(word.data(), word.data() + word.size(), value);
  return code == std::errc() && end == word.data() + word.size();
}

/// First address of a family on an interface, as bytes for bind(), except link-local ones (meant for one machine).
socklen_t address_of(const std::string& name, int family, int port, sockaddr_storage& result) {
  ifaddrs* all = nullptr;
  if (::getifaddrs(&all) != 0) refuse("The network interfaces cannot be read.");
  std::string known;
  socklen_t size = 0;
  for (const ifaddrs* one = all; one != nullptr; one = one->ifa_next) {
    if (one->ifa_addr == nullptr || one->ifa_addr->sa_family != family) continue;
    const auto* in6 = reinterpret_cast<const sockaddr_in6*>(one->ifa_addr);
    if (family == AF_INET6 && IN6_IS_ADDR_LINKLOCAL(&in6->sin6_addr)) continue;
    if (known.find(one->ifa_name) == std::string::npos)
      known += (known.empty() ? "" : ", ") + std::string(one->ifa_name);
    if (size == 0 && name == one->ifa_name) {
      size = family == AF_INET6 ? sizeof(sockaddr_in6) : sizeof(sockaddr_in);
      std::memcpy(&result, one->ifa_addr, size);
      (family == AF_INET6 ? reinterpret_cast<sockaddr_in6&>(result).sin6_port
                          : reinterpret_cast<sockaddr_in&>(result).sin_port) = htons(std::uint16_t(port));
    }
  }
  ::freeifaddrs(all);
  if (size == 0)
    refuse("There is no network interface '" + name + "' with an IPv" + (family == AF_INET6 ? '6' : '4') +
           " address; the available interfaces are: " + known + ".");
  return size;
}

int listen_on_tcp(const std::string& where, int family, std::string& place) {
  const std::size_t colon = where.find(':');
  int port = 0;
  if (colon != std::string::npos && (!whole(where.substr(colon + 1), port) || port < 0 || port > 65535))
    refuse("'" + where.substr(colon + 1) + "' is not a port; expected a whole number from 0 (any) to 65535.");
  sockaddr_storage at{};
  socklen_t size = address_of(where.substr(0, colon), family, port, at);
  const int s = ::socket(family, SOCK_STREAM | SOCK_CLOEXEC, 0);
  const int on = 1;
  widen(s);
  ::setsockopt(s, SOL_SOCKET, SO_REUSEADDR, &on, sizeof on);
  if (s < 0 || ::bind(s, reinterpret_cast<sockaddr*>(&at), size) != 0 || ::listen(s, 8) != 0)
    refuse("Cannot listen on '" + where + "' (" + std::strerror(errno) + ").");
  ::getsockname(s, reinterpret_cast<sockaddr*>(&at), &size);
  char text[INET6_ADDRSTRLEN] = "", number[8] = "";
  ::getnameinfo(reinterpret_cast<sockaddr*>(&at), size, text, sizeof text, number, sizeof number,
                NI_NUMERICHOST | NI_NUMERICSERV);
  place = std::string("tcp ") + text + ' ' + number;
  return s;
}

int listen_on_unix(std::string& place, std::string& folder) {
  const char* top = std::getenv("TMPDIR");
  folder = std::string(top != nullptr && std::strlen(top) < 60 ? top : "/tmp") + "/couplet-relay-XXXXXX";
  if (::mkdtemp(folder.data()) == nullptr)  // only for its owner
    refuse("Cannot make a folder '" + folder + "' for the socket (" + std::strerror(errno) + ").");
  const std::string path = folder + "/socket";
  sockaddr_un at{};
  at.sun_family = AF_UNIX;
  std::strncpy(at.sun_path, path.c_str(), sizeof at.sun_path - 1);
  const int s = ::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);
  widen(s);
  if (s < 0 || ::bind(s, reinterpret_cast<sockaddr*>(&at), sizeof at) != 0 || ::listen(s, 8) != 0)
    refuse("Cannot listen at '" + path + "' (" + std::strerror(errno) + ").");
  place = "unix " + path;
  return s;
}

}  // namespace

int listen_at(const std::string& how, std::string& place, std::string& folder) {
  if (how == "unix") return listen_on_unix(place, folder);
  if (how.rfind("tcp:", 0) == 0) return listen_on_tcp(how.substr(4), AF_INET, place);
  if (how.rfind("tcp6:", 0) == 0) return listen_on_tcp(how.substr(5), AF_INET6, place);
  refuse("--listen " + how + ": expected unix, or tcp:INTERFACE[:PORT], or tcp6:INTERFACE[:PORT].");
}

/// Parses a numeric address of either family. Returns 0 if it is not one.
static socklen_t numeric_address(const std::string& host, const std::string& port, sockaddr_storage& result) {
  addrinfo wanted{}, *found = nullptr;
  wanted.ai_family = AF_UNSPEC;
  wanted.ai_socktype = SOCK_STREAM;
  wanted.ai_flags = AI_NUMERICHOST | AI_NUMERICSERV;
  if (::getaddrinfo(host.c_str(), port.c_str(), &wanted, &found) != 0) return 0;
  const socklen_t size = found->ai_addrlen;
  std::memcpy(&result, found->ai_addr, size);
  ::freeaddrinfo(found);
  return size;
}

Stream connect_to(const std::string& place) {
  std::istringstream words(place);
  std::string kind, where, port;
  words >> kind >> where >> port;
  sockaddr_storage at{};
  socklen_t size = 0;
  std::uint16_t number = 0;
  if (kind == "unix" && where.size() < sizeof(sockaddr_un{}.sun_path)) {
    auto& un = reinterpret_cast<sockaddr_un&>(at);
    un.sun_family = AF_UNIX;
    std::strncpy(un.sun_path, where.c_str(), sizeof un.sun_path - 1);
    size = sizeof un;
  } else if (kind == "tcp" && whole(port, number)) {
    size = numeric_address(where, port, at);
  }
  if (size == 0) {
    refuse("'" + place + "' is not an address; expected 'unix PATH' or 'tcp ADDRESS PORT'.");
  }
  Stream stream(::socket(at.ss_family, SOCK_STREAM | SOCK_CLOEXEC, 0));
  widen(stream.descriptor());
  if (!stream.open() || ::connect(stream.descriptor(), reinterpret_cast<sockaddr*>(&at), size) != 0)
    refuse("cannot connect to the relay at '" + place + "' (" + std::strerror(errno) + ").");
  if (kind == "tcp") watch(stream.descriptor());
  return stream;
}

void Address::write(const std::string& file) const {
  const std::string part = file + ".part";
  ::unlink(part.c_str());
  const int descriptor = ::open(part.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, S_IRUSR | S_IWUSR);
  std::string text = std::string(file_mark) + "\nparticipant " + participant + "\ntoken " + token + '\n';
  for (const std::string& place : places) text += place + '\n';
  const bool good = descriptor >= 0 && ::write(descriptor, text.data(), text.size()) == ssize_t(text.size());
  if (descriptor >= 0) ::close(descriptor);
  if (!good || ::rename(part.c_str(), file.c_str()) != 0)
    refuse("Cannot write '" + file + "' (" + std::strerror(errno) + ").");
}

Address Address::read(const std::string& file) {
  std::ifstream opened(file);
  std::string text(1 << 20, '\0');  // far more than ten thousand addresses
  if (opened) opened.read(text.data(), std::streamsize(text.size()));
  text.resize(std::size_t(std::max<std::streamsize>(0, opened.gcount())));
  std::istringstream in(text);
  if (!opened.is_open()) refuse("COUPLET_JOIN: cannot read '" + file + "' (" + std::strerror(errno) + ").");
  Address result;
  std::string line;
  std::getline(in, line);
  if (line != file_mark) refuse("COUPLET_JOIN: '" + file + "' was not written by a relay of this version.");
  std::getline(in, line);
  if (line.rfind("participant ", 0) == 0) result.participant = line.substr(12);
  std::getline(in, line);
  if (line.rfind("token ", 0) == 0) result.token = line.substr(6);
  while (std::getline(in, line)) result.places.push_back(line);
  if (result.participant.empty() || result.token.empty() || result.places.empty())
    refuse("COUPLET_JOIN: '" + file + "' is damaged; expected participant, token and places.");
  return result;
}

std::string Greeting::line() const {
  return std::string(greeting_mark) + ' ' + std::to_string(version) + ' ' + token + ' ' +
         std::to_string(rank) + ' ' + std::to_string(size) + ' ' + participant;
}

bool Greeting::parse(const std::string& line, Greeting& result) {
  std::istringstream words(line);
  std::string mark, number, rank, size;
  std::int64_t theirs = 0;
  words >> mark >> number >> result.token >> rank >> size;
  if (!words || mark != greeting_mark || !whole(number, theirs) || theirs != version) return false;
  words.get();
  std::getline(words, result.participant);
  return whole(rank, result.rank) && whole(size, result.size) && !result.participant.empty();
}

}  // namespace couplet::wire
