// SPDX-License-Identifier: Apache-2.0
// Follows docs/protocol.md and needs nothing but MPI.
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

#include "wire.hpp"

namespace {

using namespace couplet_wire;

[[noreturn]] void end_the_job(const std::string& text) {
  std::fprintf(stderr, "couplet client: %s\n", text.c_str());
  std::fflush(nullptr);
  MPI_Abort(MPI_COMM_WORLD, 1);
  std::abort();
}

}  // namespace

struct couplet_client {
  std::string participant;
  MPI_Comm comm = MPI_COMM_NULL, coupler = MPI_COMM_NULL;
  int rank = 0;
  Surface surface;
  std::vector<Datum> takes, gives;
  // of the command under way
  Command command;
  bool pending = false;
  std::map<std::string, std::vector<double>> output;
  std::int64_t status = 0;
  std::string text, checkpoint;
  double time = 0, dt = 0;  // of the step that began last
  double advised = std::numeric_limits<double>::infinity();
  std::int64_t iterations = 0;
  double error = NAN, energy = NAN, started = 0;
};

namespace {

std::size_t entries(const couplet_client& c, const Datum& d) {
  const std::size_t places = d.place == COUPLET_VERTICES ? c.surface.vertices() : c.surface.faces();
  return places * std::size_t(d.size(c.surface.dim));
}

const Datum* find(const std::vector<Datum>& list, const std::string& name) {
  for (const Datum& d : list)
    if (d.name == name) return &d;
  return nullptr;
}

void send_reply(couplet_client& c) {
  if (c.rank != 0) return;
  const bool first = c.command.op == initialise;
  const Surface nothing;
  const Surface& s = first ? c.surface : nothing;
  const bool has_corners = !s.corners.empty();
  Packer out;
  out.integers({reply_mark, version, c.status});
  out.text(c.text);
  out.real(MPI_Wtime() - c.started);
  out.real(c.advised);
  out.table(c.status == 0 ? c.output : std::map<std::string, std::vector<double>>{});
  out.integers({s.dim, 0});  // not a closed fluid
  out.points(s.xyz);
  out.points(s.centres);
  out.points(s.areas);
  out.list(has_corners ? s.first : std::vector<std::int64_t>{});
  out.list(s.corners);
  out.data(first ? c.takes : std::vector<Datum>{});
  out.data(first ? c.gives : std::vector<Datum>{});
  out.real(c.dt);
  out.integers({c.iterations});
  out.real(c.error);
  out.real(c.energy);
  send(c.coupler, 0, reply_tag, out.bytes(), MPI_BYTE);
}

/// All data must be known and have the announced length.
void check_input(const couplet_client& c) {
  for (const auto& [name, values] : c.command.data) {
    const Datum* d = find(c.takes, name);
    if (d == nullptr)
      end_the_job("the coupler sent '" + name + "', which '" + c.participant + "' does not take.");
    if (c.rank == 0 && values.size() != entries(c, *d))
      end_the_job("the coupler sent " + std::to_string(values.size()) + " values of '" + name + "' where " +
                  std::to_string(entries(c, *d)) + " were announced.");
  }
}

void receive_command(couplet_client& c) {
  std::vector<char> head;
  if (c.rank == 0) head = receive<char>(c.coupler, 0, command_tag, MPI_BYTE);
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
  c.output.clear();
  c.status = 0;
  c.text.clear();
  if (c.rank != 0)
    for (auto& entry : c.command.data) entry.second.clear();
  check_input(c);
  c.pending = true;
}

/// What was announced must be given, whole.
void check_output(couplet_client& c) {
  if (c.rank != 0 || c.command.op != solve || c.status != 0) return;
  for (const Datum& d : c.gives)
    if (!c.output.count(d.name))
      end_the_job("'" + c.participant + "' did not give '" + d.name + "' before couplet_next.");
}

}  // namespace

extern "C" {

couplet_client* couplet_join(const char* participant, const char* program) try {
  int up = 0;
  MPI_Initialized(&up);
  if (!up) end_the_job("MPI_Init must come before couplet_join.");
  auto c = std::make_unique<couplet_client>();
  c->participant = participant;
  const Place place = join(participant, program);
  if (!place.starts) {
    MPI_Finalize();
    std::exit(2);
  }
  c->comm = place.comm;
  c->coupler = place.coupler;
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
      case finalise:
        continue;  // answered by this library
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
  const auto found = c->command.data.find(datum);
  return found == c->command.data.end() || found->second.empty() ? nullptr : found->second.data();
}

void couplet_write(couplet_client* c, const char* datum, const double* values) {
  const Datum* d = find(c->gives, datum);
  if (!d) end_the_job(std::string("'") + datum + "' was not announced by couplet_gives.");
  c->output[datum].assign(values, values + entries(*c, *d));
}

void couplet_fail(couplet_client* c, const char* why) {
  c->status = 1;
  c->text = why;
}

void couplet_advise(couplet_client* c, double dt) { c->advised = dt; }

void couplet_report(couplet_client* c, int64_t iterations, double error, double energy) {
  c->iterations = iterations;
  c->error = error;
  c->energy = energy;
}

void couplet_leave(couplet_client* c) { delete c; }

}  // extern "C"
