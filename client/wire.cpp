// SPDX-License-Identifier: Apache-2.0
#include "wire.hpp"

#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <sstream>

namespace couplet::wire {
namespace {

/// Splits own entries [low, high) of n by coupler rank: rank r of R has [n r / R, n (r + 1) / R).
template <class Take>
void for_overlaps(std::int64_t low, std::int64_t high, std::int64_t n, int ranks, Take take) {
  for (int r = 0; r < ranks; ++r) {
    const std::int64_t first = std::max(low, n * r / ranks), end = std::min(high, n * (r + 1) / ranks);
    if (first < end) take(r, std::size_t(first - low), std::size_t(end - first));
  }
}

class Reader {
 public:
  explicit Reader(const std::vector<char>& bytes) : bytes_(bytes) {}
  std::int64_t integer() { return plain<std::int64_t>(); }
  double real() { return plain<double>(); }
  std::size_t left() const { return bytes_.size() - at_; }
  std::string text() {
    const std::int64_t n = integer();
    if (n < 0 || std::size_t(n) > bytes_.size() - at_) throw std::runtime_error("a command is truncated.");
    std::string value(bytes_.data() + at_, std::size_t(n));
    at_ += std::size_t(n);
    return value;
  }

 private:
  template <class T>
  T plain() {
    T value;
    if (sizeof value > bytes_.size() - at_) throw std::runtime_error("a command is truncated.");
    std::memcpy(&value, bytes_.data() + at_, sizeof value);
    at_ += sizeof value;
    return value;
  }
  const std::vector<char>& bytes_;
  std::size_t at_ = 0;
};

/// Fields of one process at the roll call. Each ends with 0x1f, all of them with 0x1e.
std::string introduction(const std::string& participant, const std::string& program, int application,
                         int rank) {
  std::string text;
  char machine[256] = "";
  ::gethostname(machine, sizeof machine - 1);
  for (const std::string& field :
       {program, participant, std::string("(guest)"), std::string("0"), std::string(), std::string("1"),
        std::to_string(application), std::to_string(rank), std::to_string(::getpid()) + "@" + machine})
    text += field + '\x1f';
  return text + '\x1e';
}

/// Participant of each process, by rank.
std::vector<std::string> roll_call(const std::string& mine, int size) {
  std::vector<int> counts(static_cast<std::size_t>(size)), first;
  const int length = int(mine.size());
  MPI_Allgather(&length, 1, MPI_INT, counts.data(), 1, MPI_INT, MPI_COMM_WORLD);
  int total = 0;
  for (const int n : counts) first.push_back(total), total += n;
  std::string all(std::size_t(total), '\0');
  MPI_Allgatherv(mine.data(), length, MPI_BYTE, all.data(), counts.data(), first.data(), MPI_BYTE,
                 MPI_COMM_WORLD);
  std::vector<std::string> participants;
  std::istringstream in(all);
  for (std::string one; std::getline(in, one, '\x1e');) {
    std::istringstream fields(one);
    std::string program, participant;
    std::getline(fields, program, '\x1f');
    std::getline(fields, participant, '\x1f');
    participants.push_back(participant);
  }
  return participants;
}

}  // namespace

std::vector<Peer> peers_of(const std::vector<std::int64_t>& vertex_cut,
                           const std::vector<std::int64_t>& face_cut, int rank, int coupler_ranks) {
  std::map<int, Peer> peers;
  const auto r = std::size_t(rank);
  for_overlaps(vertex_cut[r], vertex_cut[r + 1], vertex_cut.back(), coupler_ranks,
               [&](int to, std::size_t first, std::size_t count) {
                 peers[to].first_vertex = first, peers[to].vertices = count;
               });
  for_overlaps(face_cut[r], face_cut[r + 1], face_cut.back(), coupler_ranks,
               [&](int to, std::size_t first, std::size_t count) {
                 peers[to].first_face = first, peers[to].faces = count;
               });
  std::vector<Peer> list;
  for (auto& [to, peer] : peers) {
    peer.rank = to;
    list.push_back(peer);
  }
  return list;
}

std::vector<char> Surface::cut_out(const Peer& p) const {
  Packer out;
  out.integers({std::int64_t(p.vertices)});
  for (std::size_t v = p.first_vertex; v < p.first_vertex + p.vertices; ++v) {
    out.integers({std::int64_t(v)});
    out.raw(&xyz[3 * v], 24);
  }
  out.integers({std::int64_t(p.faces)});
  for (std::size_t f = p.first_face; f < p.first_face + p.faces; ++f) {
    out.integers({std::int64_t(f)});
    out.raw(&centres[3 * f], 24);
    out.raw(&areas[3 * f], 24);
    out.integers({first[f + 1] - first[f]});
    for (std::int64_t k = first[f]; k < first[f + 1]; ++k) out.integers({corners[std::size_t(k)]});
  }
  out.integers({surface.empty() ? 0 : std::int64_t(p.vertices)});
  for (std::size_t v = p.first_vertex; !surface.empty() && v < p.first_vertex + p.vertices; ++v)
    out.integers({surface[v]});
  return out.bytes();
}

namespace {

/// Segments as one MPI datatype relative to MPI_BOTTOM.
class Layout {
 public:
  explicit Layout(const std::vector<Stretch>& parts) {
    std::vector<int> counts;
    std::vector<MPI_Aint> places;
    for (const Stretch& part : parts) {
      counts.push_back(int(part.count));
      total_ += part.count;
      MPI_Aint at = 0;
      MPI_Get_address(part.first, &at);
      places.push_back(at);
    }
    MPI_Type_create_hindexed(int(parts.size()), counts.data(), places.data(), MPI_DOUBLE, &type_);
    MPI_Type_commit(&type_);
  }
  ~Layout() { MPI_Type_free(&type_); }
  Layout(const Layout&) = delete;
  MPI_Datatype type() const { return type_; }
  std::size_t total() const { return total_; }

 private:
  MPI_Datatype type_ = MPI_DATATYPE_NULL;
  std::size_t total_ = 0;
};

class MpiLink : public Link {
 public:
  explicit MpiLink(MPI_Comm coupler) : coupler_(coupler) {}

  int ranks() const override {
    int n = 0;
    MPI_Comm_remote_size(coupler_, &n);
    return n;
  }

  void send(int to, int tag, const std::vector<char>& bytes) override {
    wire::send(coupler_, to, tag, bytes, MPI_BYTE);
  }

  void send(int to, int tag, const std::vector<Stretch>& parts) override {
    const Layout layout(parts);
    MPI_Request request;
    MPI_Isend(MPI_BOTTOM, 1, layout.type(), to, tag, coupler_, &request);
    wait(request);
  }

  std::vector<char> receive(int from, int tag) override {
    return wire::receive<char>(coupler_, from, tag, MPI_BYTE);
  }

  bool receive(int from, int tag, const std::vector<Stretch>& parts) override {
    const Layout layout(parts);
    MPI_Status status;
    MPI_Message message = await_message(coupler_, from, tag, status);
    int bytes = 0;
    MPI_Get_count(&status, MPI_BYTE, &bytes);
    if (std::size_t(bytes) != layout.total() * sizeof(double)) return false;
    MPI_Mrecv(MPI_BOTTOM, 1, layout.type(), &message, MPI_STATUS_IGNORE);
    return true;
  }

 private:
  MPI_Comm coupler_;
};

}  // namespace

bool receive_any(MPI_Comm peers, int& from, int& tag, std::vector<char>& bytes) {
  int there = 0, count = 0;
  MPI_Message message;
  MPI_Status status;
  MPI_Improbe(MPI_ANY_SOURCE, MPI_ANY_TAG, peers, &there, &message, &status);
  if (!there) return false;
  MPI_Get_count(&status, MPI_BYTE, &count);
  bytes.resize(std::size_t(count));
  MPI_Mrecv(bytes.data(), count, MPI_BYTE, &message, MPI_STATUS_IGNORE);
  from = status.MPI_SOURCE, tag = status.MPI_TAG;
  return true;
}

std::unique_ptr<Link> link_by_mpi(MPI_Comm coupler) { return std::make_unique<MpiLink>(coupler); }

Command unpack(const std::vector<char>& head) {
  Reader in(head);
  if (in.integer() != command_mark) throw std::runtime_error("a message of the coupler is not a command.");
  if (const auto v = in.integer(); v != version)
    throw std::runtime_error("the coupler uses version " + std::to_string(v) +
                             " of the protocol, but this client uses " + std::to_string(version) + ".");
  Command c;
  c.op = in.integer();
  if (c.op < 1 || c.op > 9)
    throw std::runtime_error("the coupler sent command " + std::to_string(c.op) +
                             ", which is unknown to this client.");
  c.time = in.real();
  c.dt = in.real();
  c.scheme = in.integer();
  c.number = in.integer();
  c.sub_steps = in.integer();
  c.accepted = in.real();
  c.output = in.integer();
  c.folder = in.text();
  const std::int64_t n = in.integer();
  if (n < 0 || std::size_t(n) > in.left() / 8) throw std::runtime_error("a command is truncated.");
  for (std::int64_t i = 0; i < n; ++i) c.data.push_back(in.text());
  if (in.left() != 0) throw std::runtime_error("a command is longer than its content.");
  return c;
}

Place join(const std::string& participant, const std::string& program) {
  int rank = 0, size = 0, found = 0;
  int* application = nullptr;
  MPI_Comm_rank(MPI_COMM_WORLD, &rank);
  MPI_Comm_size(MPI_COMM_WORLD, &size);
  MPI_Comm_get_attr(MPI_COMM_WORLD, MPI_APPNUM, &application, &found);
  int number = found ? *application : 0;
  if (const char* part = std::getenv("COUPLET_PART")) number = std::atoi(part);
  // 1. Handshake.
  const std::int64_t hello[4] = {hello_mark, version, 1, 0};
  std::vector<std::int64_t> all(4 * std::size_t(size));
  MPI_Request request;
  MPI_Iallgather(hello, 4, MPI_INT64_T, all.data(), 4, MPI_INT64_T, MPI_COMM_WORLD, &request);
  wait(request);
  for (std::size_t r = 0; r < std::size_t(size); ++r)
    if (all[4 * r] != hello_mark)
      throw std::runtime_error("process " + std::to_string(r) + " of the job uses another protocol.");
  for (std::size_t r = 0; r < std::size_t(size); ++r)
    if (all[4 * r + 1] != version)
      throw std::runtime_error("process " + std::to_string(r) + " of the job uses version " +
                               std::to_string(all[4 * r + 1]) + " of the protocol, but this client uses " +
                               std::to_string(version) +
                               ": use the client library and the programs of one version of Couplet.");
  // 2. Guests are not part of the programs' own communicator.
  MPI_Comm nobody;
  MPI_Comm_split(MPI_COMM_WORLD, MPI_UNDEFINED, rank, &nobody);
  // 3. Roll call.
  const std::vector<std::string> participants =
      roll_call(introduction(participant, program, number, rank), size);
  // 4. Verdict.
  Place place;
  std::int64_t problem = 0;
  MPI_Allreduce(MPI_IN_PLACE, &problem, 1, MPI_INT64_T, MPI_MAX, MPI_COMM_WORLD);
  if (problem != 0) return place;
  // 5. One communicator per participant, numbered by first appearance.
  std::vector<std::string> order;
  int color = 0, leader = 0;
  for (std::size_t r = 0; r < participants.size(); ++r) {
    if (std::find(order.begin(), order.end(), participants[r]) != order.end()) continue;
    if (participants[r] == participant) color = int(order.size());
    if (participants[r] == "coupler") leader = int(r);
    order.push_back(participants[r]);
  }
  MPI_Comm_split(MPI_COMM_WORLD, color, rank, &place.comm);
  // 6. Connection to the coupler.
  MPI_Intercomm_create(place.comm, 0, MPI_COMM_WORLD, leader, join_tag, &place.coupler);
  place.starts = true;
  return place;
}

}  // namespace couplet::wire
