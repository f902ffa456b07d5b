// SPDX-License-Identifier: Apache-2.0 Counts the messages of a program if loaded before MPI (LD_PRELOAD), by
// MPI's profiling interface (MPI 4.0, chapter 15). Includes calls of PETSc and hypre, but not from Fortran
// (MUMPS). MPI_Finalize writes COUPLET_COUNTS/<rank of the job>.json. Collectives on one rank, messages to
// oneself and polling are ignored.
#include <mpi.h>

#include <cstdio>
#include <cstdlib>
#include <map>
#include <string>
#include <vector>

extern "C" char* program_invocation_short_name;

namespace couplet::scaling {
namespace {

struct Message {
  int peer;
  double bytes;
};

struct Tally {
  std::map<int, long> messages;                // by rank of the job
  std::map<std::string, long> collectives;     // by kind
  std::map<MPI_Comm, std::vector<int>> ranks;  // of each communicator's other end, in the job
  std::map<MPI_Request, Message> persistent;
  double bytes = 0, waited = 0, collective_seconds = 0;
};

Tally& tally() {
  static Tally one;
  return one;
}

int world_rank(MPI_Comm comm, int rank) {
  auto [place, added] = tally().ranks.try_emplace(comm);
  if (added) {
    int other = 0, size = 0;
    MPI_Group group, world;
    PMPI_Comm_test_inter(comm, &other);
    other ? PMPI_Comm_remote_group(comm, &group) : PMPI_Comm_group(comm, &group);
    PMPI_Comm_group(MPI_COMM_WORLD, &world);
    PMPI_Group_size(group, &size);
    std::vector<int> all(size);
    for (int i = 0; i < size; ++i) all[i] = i;
    place->second.resize(size);
    PMPI_Group_translate_ranks(group, size, all.data(), world, place->second.data());
    PMPI_Group_free(&group);
    PMPI_Group_free(&world);
  }
  return place->second.at(rank);
}

int own_rank() {
  int rank;
  PMPI_Comm_rank(MPI_COMM_WORLD, &rank);
  return rank;
}

void send(const Message& message) {
  if (message.peer == own_rank()) return;
  ++tally().messages[message.peer];
  tally().bytes += message.bytes;
}

Message message_of(int count, MPI_Datatype type, int peer, MPI_Comm comm) {
  int size = 0;
  PMPI_Type_size(type, &size);
  return {peer == MPI_PROC_NULL ? own_rank() : world_rank(comm, peer), double(count) * size};
}

template <class Call>
int timed(double& seconds, Call call) {
  const double start = PMPI_Wtime();
  const int result = call();
  seconds += PMPI_Wtime() - start;
  return result;
}

template <class Call>
int collective(const char* kind, MPI_Comm comm, Call call) {
  int size = 0, inter = 0;
  PMPI_Comm_size(comm, &size);
  PMPI_Comm_test_inter(comm, &inter);
  if (size > 1 || inter) ++tally().collectives[kind];
  return timed(tally().collective_seconds, call);
}

template <class Call>
int persistent(Message message, MPI_Request* request, Call call) {
  const int result = call();
  tally().persistent[*request] = message;
  return result;
}

void start(MPI_Request request) {
  const auto found = tally().persistent.find(request);
  if (found != tally().persistent.end()) send(found->second);
}

void write() {
  const char* folder = std::getenv("COUPLET_COUNTS");
  if (!folder) return;
  std::FILE* file =
      std::fopen((std::string(folder) + "/" + std::to_string(own_rank()) + ".json").c_str(), "w");
  if (!file) {
    std::fprintf(stderr, "counts: cannot write into COUPLET_COUNTS=%s\n", folder);
    return;
  }
  const Tally& t = tally();
  std::fprintf(
      file,
      "{\"program\": \"%s\", \"rank\": %d, \"bytes\": %.0f, \"waited\": %.6f, \"in_collectives\": %.6f, \"peers\": {",
      program_invocation_short_name, own_rank(), t.bytes, t.waited, t.collective_seconds);
  const char* comma = "";
  for (const auto& [peer, count] : t.messages)
    std::fprintf(file, "%s\"%d\": %ld", comma, peer, count), comma = ", ";
  std::fprintf(file, "}, \"collectives\": {");
  comma = "";
  for (const auto& [kind, count] : t.collectives)
    std::fprintf(file, "%s\"%s\": %ld", comma, kind.c_str(), count), comma = ", ";
  std::fprintf(file, "}}\n");
  std::fclose(file);
}

}  // namespace
}  // namespace couplet::scaling

using namespace couplet::scaling;

// One line per call: its arguments, then those it uses by name.
#define TYPES(...) (__VA_ARGS__)
#define SENDS(NAME, GIVEN, ...)                \
  extern "C" int MPI_##NAME GIVEN {            \
    send(message_of(count, type, peer, comm)); \
    return PMPI_##NAME(__VA_ARGS__);           \
  }
#define SENDS_LATER(NAME)                                                                        \
  extern "C" int MPI_##NAME(const void* data, int count, MPI_Datatype type, int peer, int tag,   \
                            MPI_Comm comm, MPI_Request* request) {                               \
    return persistent(message_of(count, type, peer, comm), request,                              \
                      [&] { return PMPI_##NAME(data, count, type, peer, tag, comm, request); }); \
  }
#define WAITS(NAME, GIVEN, ...)                                             \
  extern "C" int MPI_##NAME GIVEN {                                         \
    return timed(tally().waited, [&] { return PMPI_##NAME(__VA_ARGS__); }); \
  }
#define COLLECTIVE(NAME, KIND, GIVEN, ...)                                   \
  extern "C" int MPI_##NAME GIVEN {                                          \
    return collective(KIND, comm, [&] { return PMPI_##NAME(__VA_ARGS__); }); \
  }

#define BLOCKING TYPES(const void* data, int count, MPI_Datatype type, int peer, int tag, MPI_Comm comm)
#define FLYING                                                                            \
  TYPES(const void* data, int count, MPI_Datatype type, int peer, int tag, MPI_Comm comm, \
        MPI_Request* request)
SENDS(Send, BLOCKING, data, count, type, peer, tag, comm)
SENDS(Ssend, BLOCKING, data, count, type, peer, tag, comm)
SENDS(Rsend, BLOCKING, data, count, type, peer, tag, comm)
SENDS(Bsend, BLOCKING, data, count, type, peer, tag, comm)
SENDS(Isend, FLYING, data, count, type, peer, tag, comm, request)
SENDS(Issend, FLYING, data, count, type, peer, tag, comm, request)
SENDS(Irsend, FLYING, data, count, type, peer, tag, comm, request)
SENDS(Ibsend, FLYING, data, count, type, peer, tag, comm, request)
SENDS_LATER(Send_init)
SENDS_LATER(Ssend_init)
SENDS_LATER(Rsend_init)
SENDS_LATER(Bsend_init)

extern "C" int MPI_Sendrecv(const void* data, int count, MPI_Datatype type, int peer, int tag, void* got,
                            int room, MPI_Datatype got_type, int source, int got_tag, MPI_Comm comm,
                            MPI_Status* status) {
  send(message_of(count, type, peer, comm));
  return timed(tally().waited, [&] {
    return PMPI_Sendrecv(data, count, type, peer, tag, got, room, got_type, source, got_tag, comm, status);
  });
}

extern "C" int MPI_Start(MPI_Request* request) {
  start(*request);
  return PMPI_Start(request);
}

extern "C" int MPI_Startall(int count, MPI_Request* requests) {
  for (int i = 0; i < count; ++i) start(requests[i]);
  return PMPI_Startall(count, requests);
}

extern "C" int MPI_Request_free(MPI_Request* request) {
  tally().persistent.erase(*request);
  return PMPI_Request_free(request);
}

extern "C" int MPI_Comm_free(MPI_Comm* comm) {
  tally().ranks.erase(*comm);
  return PMPI_Comm_free(comm);
}

WAITS(Wait, TYPES(MPI_Request* request, MPI_Status* status), request, status)
WAITS(Waitall, TYPES(int count, MPI_Request* requests, MPI_Status* statuses), count, requests, statuses)
WAITS(Waitany, TYPES(int count, MPI_Request* requests, int* which, MPI_Status* status), count, requests,
      which, status)
WAITS(Waitsome, TYPES(int count, MPI_Request* requests, int* done, int* which, MPI_Status* statuses), count,
      requests, done, which, statuses)
WAITS(Recv,
      TYPES(void* data, int count, MPI_Datatype type, int peer, int tag, MPI_Comm comm, MPI_Status* status),
      data, count, type, peer, tag, comm, status)
WAITS(Probe, TYPES(int peer, int tag, MPI_Comm comm, MPI_Status* status), peer, tag, comm, status)
WAITS(Mprobe, TYPES(int peer, int tag, MPI_Comm comm, MPI_Message* message, MPI_Status* status), peer, tag,
      comm, message, status)
WAITS(Mrecv, TYPES(void* data, int count, MPI_Datatype type, MPI_Message* message, MPI_Status* status), data,
      count, type, message, status)

#define ONE const void *data, void *got, int count, MPI_Datatype type
COLLECTIVE(Allreduce, "allreduce", TYPES(ONE, MPI_Op op, MPI_Comm comm), data, got, count, type, op, comm)
COLLECTIVE(Iallreduce, "allreduce", TYPES(ONE, MPI_Op op, MPI_Comm comm, MPI_Request* request), data, got,
           count, type, op, comm, request)
COLLECTIVE(Reduce, "reduce", TYPES(ONE, MPI_Op op, int root, MPI_Comm comm), data, got, count, type, op, root,
           comm)
COLLECTIVE(Scan, "scan", TYPES(ONE, MPI_Op op, MPI_Comm comm), data, got, count, type, op, comm)
COLLECTIVE(Exscan, "scan", TYPES(ONE, MPI_Op op, MPI_Comm comm), data, got, count, type, op, comm)
COLLECTIVE(Reduce_scatter_block, "reduce_scatter", TYPES(ONE, MPI_Op op, MPI_Comm comm), data, got, count,
           type, op, comm)
COLLECTIVE(Reduce_scatter, "reduce_scatter",
           TYPES(const void* data, void* got, const int* counts, MPI_Datatype type, MPI_Op op, MPI_Comm comm),
           data, got, counts, type, op, comm)
COLLECTIVE(Barrier, "barrier", TYPES(MPI_Comm comm), comm)
COLLECTIVE(Ibarrier, "barrier", TYPES(MPI_Comm comm, MPI_Request* request), comm, request)
COLLECTIVE(Bcast, "bcast", TYPES(void* data, int count, MPI_Datatype type, int root, MPI_Comm comm), data,
           count, type, root, comm)
COLLECTIVE(Ibcast, "bcast",
           TYPES(void* data, int count, MPI_Datatype type, int root, MPI_Comm comm, MPI_Request* request),
           data, count, type, root, comm, request)

#define EACH const void *data, int count, MPI_Datatype type, void *got, int got_count, MPI_Datatype got_type
#define MANY                                                                                       \
  const void *data, int count, MPI_Datatype type, void *got, const int *counts, const int *places, \
      MPI_Datatype got_type
#define ALL                                                                             \
  const void *data, const int *counts, const int *places, MPI_Datatype type, void *got, \
      const int *got_counts, const int *got_places, MPI_Datatype got_type
COLLECTIVE(Gather, "gather", TYPES(EACH, int root, MPI_Comm comm), data, count, type, got, got_count,
           got_type, root, comm)
COLLECTIVE(Igather, "gather", TYPES(EACH, int root, MPI_Comm comm, MPI_Request* r), data, count, type, got,
           got_count, got_type, root, comm, r)
COLLECTIVE(Gatherv, "gather", TYPES(MANY, int root, MPI_Comm comm), data, count, type, got, counts, places,
           got_type, root, comm)
COLLECTIVE(Igatherv, "gather", TYPES(MANY, int root, MPI_Comm comm, MPI_Request* r), data, count, type, got,
           counts, places, got_type, root, comm, r)
COLLECTIVE(Scatter, "scatter", TYPES(EACH, int root, MPI_Comm comm), data, count, type, got, got_count,
           got_type, root, comm)
COLLECTIVE(Scatterv, "scatter",
           TYPES(const void* data, const int* counts, const int* places, MPI_Datatype type, void* got,
                 int count, MPI_Datatype got_type, int root, MPI_Comm comm),
           data, counts, places, type, got, count, got_type, root, comm)
COLLECTIVE(Allgather, "allgather", TYPES(EACH, MPI_Comm comm), data, count, type, got, got_count, got_type,
           comm)
COLLECTIVE(Allgatherv, "allgather", TYPES(MANY, MPI_Comm comm), data, count, type, got, counts, places,
           got_type, comm)
COLLECTIVE(Alltoall, "alltoall", TYPES(EACH, MPI_Comm comm), data, count, type, got, got_count, got_type,
           comm)
COLLECTIVE(Alltoallv, "alltoall", TYPES(ALL, MPI_Comm comm), data, counts, places, type, got, got_counts,
           got_places, got_type, comm)
COLLECTIVE(Neighbor_alltoallv, "neighbour", TYPES(ALL, MPI_Comm comm), data, counts, places, type, got,
           got_counts, got_places, got_type, comm)

extern "C" int MPI_Finalize() {
  write();
  return PMPI_Finalize();
}
