// SPDX-License-Identifier: Apache-2.0
// Follows docs/protocol.md and depends only on MPI.
#include <sched.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <limits>
#include <map>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "client.hpp"
#include "socket_link.hpp"
#include "transports.hpp"

using namespace couplet::wire;

static Link* way = nullptr;  // of the last client that joined

[[noreturn]] void couplet::wire::end_the_job(const std::string& text) {
  std::fprintf(stderr, "couplet client: %s\n", text.c_str());
  if (way != nullptr) way->fail(text);
  std::fflush(nullptr);
  MPI_Abort(MPI_COMM_WORLD, 1);
  std::abort();
}

namespace {

std::vector<std::int64_t> cut(MPI_Comm comm, std::size_t n) {
  int size = 0;
  MPI_Comm_size(comm, &size);
  std::vector<std::int64_t> counts(static_cast<std::size_t>(size)), starts{0};
  const auto mine = std::int64_t(n);
  MPI_Allgather(&mine, 1, MPI_INT64_T, counts.data(), 1, MPI_INT64_T, comm);
  for (const std::int64_t count : counts) starts.push_back(starts.back() + count);
  return starts;
}

/// Appends peer `p`'s segment of a datum, if any, to `parts`.
void part_of(const couplet_client& c, const Peer& p, const Datum& d, std::vector<double>& values,
             std::vector<Stretch>& parts) {
  const auto n = std::size_t(d.size(c.surface.dim));
  const std::size_t first = n * (d.place == COUPLET_FACES ? p.first_face : p.first_vertex),
                    count = n * (d.place == COUPLET_FACES ? p.faces : p.vertices);
  if (count > 0) parts.push_back({values.data() + first, count});
}

/// Replies to initialise: the head, then vertices and faces to the coupler ranks that receive some of them.
void describe(couplet_client& c) {
  MPI_Bcast(&c.surface.dim, 1, MPI_INT, 0, c.comm);
  c.vertex_cut = cut(c.comm, c.surface.vertices());
  c.face_cut = cut(c.comm, c.surface.faces());
  c.peers = peers_of(c.vertex_cut, c.face_cut, c.rank, c.coupler->ranks());
  c.described = true;
}

void send_reply(couplet_client& c) {
  const bool first = c.command.op == initialise;
  if (first) describe(c);
  if (c.rank == 0) {
    Packer head;
    head.integers({reply_mark, version, c.status});
    head.text(first && c.status == 0 ? c.introduction : c.text);
    head.real(MPI_Wtime() - c.started);
    head.real(c.advised);
    head.real(c.dt);
    head.integers({c.iterations});
    head.real(c.error);
    head.real(c.energy);
    head.real(NAN);  // change of the solution
    head.names(c.output);
    head.integers({c.surface.dim, 0});  // dimension, comparable to earlier passes
    head.data(first ? c.takes : std::vector<Datum>{});
    head.data(first ? c.gives : std::vector<Datum>{});
    head.list(first ? c.vertex_cut : std::vector<std::int64_t>{0});
    head.list(first ? c.face_cut : std::vector<std::int64_t>{0});
    c.coupler->send(0, reply_tag, head.bytes());
  }
  if (first)
    for (const Peer& p : c.peers) c.coupler->send(p.rank, places_tag, c.surface.cut_out(p));
  if ((c.command.op == solve || first) && c.status == 0)
    for (const Peer& p : c.peers) {
      std::vector<Stretch> parts;
      for (auto& [name, values] : c.output) part_of(c, p, *find(c.gives, name), values, parts);  // by name
      if (!parts.empty()) c.coupler->send(p.rank, output_tag, parts);
    }
  if (c.spare.size() > c.gives.size() + c.output.size()) c.spare.clear();  // for other times within the step
  for (auto& [name, values] : c.output) c.spare[name].swap(values);
  c.output.clear();
  c.status = 0;
  c.text.clear();
}

void receive_input(couplet_client& c) {
  std::map<std::string, const Datum*> present;
  for (const std::string& name : c.command.data) {
    const Datum* d = find(c.takes, name);
    if (d == nullptr)
      end_the_job("the coupler sent '" + name + "', which '" + c.participant + "' does not take.");
    if (entries(c, *d) > 0) present[name] = d;
  }
  // Reuses the arrays of the previous pass. Data that nobody has given this time are absent.
  auto before = std::exchange(c.input, {});
  for (const auto& [name, d] : present) {
    std::vector<double>& values = c.input[name];
    values.swap(before[name]);
    values.resize(entries(c, *d));
  }
  for (const Peer& p : c.peers) {
    std::vector<Stretch> parts;
    for (const auto& [name, d] : present) part_of(c, p, *d, c.input[name], parts);  // by name
    if (!parts.empty() && !c.coupler->receive(p.rank, input_tag, parts))
      end_the_job("a message with values does not have the announced length.");
  }
}

void receive_command(couplet_client& c) {
  std::vector<char> head;
  if (c.rank == 0) head = c.coupler->receive(0, command_tag);
  auto n = std::int64_t(head.size());
  broadcast(c.comm, &n, sizeof n);
  head.resize(std::size_t(n));
  broadcast(c.comm, head.data(), head.size());
  c.command = unpack(head);
  c.started = MPI_Wtime();
  if (c.command.op == begin) c.time = c.command.time, c.dt = c.command.dt;
  c.iterations = 0;
  c.error = c.energy = NAN;
  c.checkpoint = c.command.folder + "/" + c.participant;
  if (c.command.op == solve || !c.command.data.empty()) receive_input(c);
  c.pending = true;
}

/// Checks that all announced data were given completely.
void check_output(couplet_client& c) {
  if (c.command.op != solve || c.status != 0) return;
  for (const Datum& d : c.gives)
    if (!c.output.count(d.name))
      end_the_job("'" + c.participant + "' did not give '" + d.name + "' before couplet_next.");
}

}  // namespace

extern "C" {

couplet_client* couplet_join(const char* participant, const char* program) {
  return couplet_join_with(participant, program, MPI_COMM_WORLD);
}

couplet_client* couplet_join_with(const char* participant, const char* program, MPI_Comm processes) try {
  int up = 0;
  MPI_Initialized(&up);
  if (!up) {
    choose_transports();
    MPI_Init(nullptr, nullptr);
  }
  auto c = std::make_unique<couplet_client>();
  c->started_mpi = !up;
  c->participant = participant;
  if (const char* file = std::getenv("COUPLET_JOIN"); file != nullptr && *file != 0) {
    MPI_Comm_dup(processes, &c->comm);
    c->coupler = link_by_socket(file, participant, c->comm);
  } else {
    const Place place = join(participant, program);
    if (!place.starts) {
      MPI_Finalize();
      std::exit(2);
    }
    c->comm = place.comm;
    c->coupler = link_by_mpi(place.coupler);
  }
  way = c->coupler.get();
  MPI_Comm_rank(c->comm, &c->rank);
  return c.release();
} catch (const std::exception& error) {
  end_the_job(error.what());
}

MPI_Comm couplet_comm(const couplet_client* c) { return c->comm; }

void couplet_vertices(couplet_client* c, int dimension, int n, const double* xyz) {
  c->surface.dim = dimension;
  c->surface.xyz.assign(xyz, xyz + 3 * n);
}

void couplet_surfaces(couplet_client* c, const int* surface_of_vertex) {
  c->surface.surface.assign(surface_of_vertex, surface_of_vertex + c->surface.vertices());
}

void couplet_faces(couplet_client* c, int n, const double* centres, const double* areas, const int64_t* first,
                   const int64_t* vertices) {
  c->surface.centres.assign(centres, centres + 3 * n);
  c->surface.areas.assign(areas, areas + 3 * n);
  c->surface.first.assign(std::size_t(n) + 1, 0);
  c->surface.corners.clear();
  if (first == nullptr) return;
  c->surface.first.assign(first, first + n + 1);
  c->surface.corners.assign(vertices, vertices + first[n]);
}

void couplet_takes(couplet_client* c, const char* datum, const char* unit, enum couplet_place place,
                   int components) {
  c->takes.push_back({datum, unit, int(place), components});
}

void couplet_gives(couplet_client* c, const char* datum, const char* unit, enum couplet_place place,
                   int components) {
  c->gives.push_back({datum, unit, int(place), components});
}

void couplet_introduce(couplet_client* c, const char* text) { c->introduction = text; }

enum couplet_event couplet_next(couplet_client* c) try {
  for (;;) {
    if (c->pending) {
      check_output(*c);
      send_reply(*c);
      c->pending = false;
      if (c->command.op == finalise) return COUPLET_END;
    }
    receive_command(*c);
    switch (c->command.op) {
      case initialise:
        if (c->command.sub_steps > 1)
          end_the_job(
              "'coupling.sub-steps' of '" + c->participant +
              "': this library takes one step per coupling step; remove it, and subdivide the step in your "
              "own program.");
        continue;
      case finalise:
        continue;  // handled by this library
      default:
        return couplet_event(c->command.op);
    }
  }
} catch (const std::exception& error) {
  end_the_job(error.what());
}

double couplet_time(const couplet_client* c) {
  return c->command.op == COUPLET_ACCEPT || c->command.op == COUPLET_OUTPUT ? c->command.accepted : c->time;
}
double couplet_dt(const couplet_client* c) { return c->dt; }
int couplet_output(const couplet_client* c) { return int(c->command.output); }
const char* couplet_checkpoint(const couplet_client* c) { return c->checkpoint.c_str(); }

const double* couplet_read(const couplet_client* c, const char* datum) {
  if (!find(c->takes, datum)) end_the_job(std::string("'") + datum + "' was not announced by couplet_takes.");
  const auto found = c->input.find(datum);
  return found == c->input.end() ? nullptr : found->second.data();
}

void couplet_write(couplet_client* c, const char* datum, const double* values) {
  const Datum* d = find(c->gives, datum);
  if (!d) end_the_job(std::string("'") + datum + "' was not announced by couplet_gives.");
  take_over(*c, datum, values, entries(*c, *d));
}

void couplet_fail(couplet_client* c, const char* why, int halving_helps) {
  c->status = halving_helps ? 1 : 2;
  c->text = why;
}

void couplet_quit(couplet_client* c, const char* why) {
  c->status = 3;
  c->text = why;
}

void couplet_advise(couplet_client* c, double dt) { c->advised = dt; }

void couplet_report(couplet_client* c, int64_t iterations, double error, double energy) {
  c->iterations = iterations;
  c->error = error;
  c->energy = energy;
}

void couplet_leave(couplet_client* c) {
  c->coupler->leave();
  if (way == c->coupler.get()) way = nullptr;
  const bool finalise = c->started_mpi;
  delete c;
  if (finalise) MPI_Finalize();
}

}  // extern "C"
