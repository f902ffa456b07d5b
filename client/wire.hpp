// SPDX-License-Identifier: Apache-2.0
// Bytes and messages of docs/protocol.md, private to the client library.
#pragma once

#include <mpi.h>
#include <sched.h>

#include <chrono>
#include <cstdint>
#include <cstring>
#include <map>
#include <memory>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "couplet.h"
#include "link.hpp"

namespace couplet::wire {

constexpr std::int64_t version = 8, command_mark = 0x434f4d4d, reply_mark = 0x5245504c,
                       hello_mark = 0x434f55504c4554;
constexpr int join_tag = 100, command_tag = 101, reply_tag = 102, input_tag = 103, places_tag = 104,
              output_tag = 105;
enum Operation : std::int64_t { initialise = 1, begin = 2, solve = 3, accept = 4, finalise = 8 };

struct Datum {
  std::string name, unit;
  int place = 0, components = 0;
  int size(int dim) const { return components > 0 ? components : dim; }
};

/// Rank of the coupler and its part of this rank's vertices and faces.
struct Peer {
  int rank = 0;
  std::size_t first_vertex = 0, vertices = 0, first_face = 0, faces = 0;
};
std::vector<Peer> peers_of(const std::vector<std::int64_t>& vertex_cut,
                           const std::vector<std::int64_t>& face_cut, int rank, int coupler_ranks);

struct Surface {
  int dim = 3;
  std::vector<double> xyz, centres, areas;
  std::vector<std::int64_t> first{0}, corners;
  std::vector<int> surface;  // of each vertex; empty if there is only one
  std::size_t vertices() const { return xyz.size() / 3; }
  std::size_t faces() const { return centres.size() / 3; }
  std::vector<char> cut_out(const Peer& p) const;
};

class Packer {
 public:
  void raw(const void* data, std::size_t size) {
    const char* first = static_cast<const char*>(data);
    bytes_.insert(bytes_.end(), first, first + size);
  }
  void integers(const std::vector<std::int64_t>& values) { raw(values.data(), 8 * values.size()); }
  void list(const std::vector<std::int64_t>& values) {
    integers({std::int64_t(values.size())});
    integers(values);
  }
  void real(double value) { raw(&value, 8); }
  void text(const std::string& value) {
    integers({std::int64_t(value.size())});
    raw(value.data(), value.size());
  }
  void names(const std::map<std::string, std::vector<double>>& data) {
    integers({std::int64_t(data.size())});
    for (const auto& entry : data) text(entry.first);
  }
  void data(const std::vector<Datum>& list) {
    integers({std::int64_t(list.size())});
    for (const Datum& d : list) {
      text(d.name);
      text(d.unit);
      integers({d.place, d.components});
    }
  }
  const std::vector<char>& bytes() const { return bytes_; }

 private:
  std::vector<char> bytes_;
};

struct Command {
  std::int64_t op = 0, scheme = 0, number = 0, sub_steps = 1, output = -1;
  double time = 0, dt = 0, accepted = 0;
  std::string folder;
  std::vector<std::string> data;
};
/// Parses a command. Throws std::runtime_error if the bytes are not a command of this version.
Command unpack(const std::vector<char>& head);

/// Result of handshake, roll call and connection. join() is collective over the whole job.
struct Place {
  bool starts = false;
  MPI_Comm comm = MPI_COMM_NULL, coupler = MPI_COMM_NULL;
};
Place join(const std::string& participant, const std::string& program);

/// Yields the core between two polls.
inline void pause(std::chrono::steady_clock::time_point since) {
  const std::chrono::duration<double> waited = std::chrono::steady_clock::now() - since;
  if (waited < std::chrono::microseconds(80))
    sched_yield();
  else
    std::this_thread::sleep_for(
        std::min<std::chrono::duration<double>>(waited / 16, std::chrono::microseconds(250)));
}

inline void wait(MPI_Request& request) {
  const auto since = std::chrono::steady_clock::now();
  for (int done = 0;;) {
    MPI_Test(&request, &done, MPI_STATUS_IGNORE);
    if (done) return;
    pause(since);
  }
}

template <class T>
void send(MPI_Comm peers, int to, int tag, const std::vector<T>& values, MPI_Datatype type) {
  MPI_Request request;
  MPI_Isend(values.data(), int(values.size()), type, to, tag, peers, &request);
  wait(request);
}

inline MPI_Message await_message(MPI_Comm peers, int from, int tag, MPI_Status& status) {
  const auto since = std::chrono::steady_clock::now();
  MPI_Message message;
  for (int there = 0;;) {
    MPI_Improbe(from, tag, peers, &there, &message, &status);
    if (there) return message;
    pause(since);
  }
}

template <class T>
std::vector<T> receive(MPI_Comm peers, int from, int tag, MPI_Datatype type) {
  MPI_Status status;
  MPI_Message message = await_message(peers, from, tag, status);
  int count = 0;
  MPI_Get_count(&status, type, &count);
  std::vector<T> values(static_cast<std::size_t>(count));
  MPI_Mrecv(values.data(), count, type, &message, MPI_STATUS_IGNORE);
  return values;
}

/// Receives the next message of any sender and tag, if there is one.
bool receive_any(MPI_Comm peers, int& from, int& tag, std::vector<char>& bytes);

inline void broadcast(MPI_Comm comm, void* data, std::size_t size) {
  MPI_Request request;
  MPI_Ibcast(data, int(size), MPI_BYTE, 0, comm, &request);
  wait(request);
}

}  // namespace couplet::wire
