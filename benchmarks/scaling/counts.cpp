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

extern "C" int MPI_Send(const void* data, int count, MPI_Datatype type, int peer, int tag, MPI_Comm comm) {
  send(message_of(count, type, peer, comm));
  return PMPI_Send(data, count, type, peer, tag, comm);
}

extern "C" int MPI_Ssend(const void* data, int count, MPI_Datatype type, int peer, int tag, MPI_Comm comm) {
  send(message_of(count, type, peer, comm));
  return PMPI_Ssend(data, count, type, peer, tag, comm);
}

extern "C" int MPI_Rsend(const void* data, int count, MPI_Datatype type, int peer, int tag, MPI_Comm comm) {
  send(message_of(count, type, peer, comm));
  return PMPI_Rsend(data, count, type, peer, tag, comm);
}

extern "C" int MPI_Bsend(const void* data, int count, MPI_Datatype type, int peer, int tag, MPI_Comm comm) {
  send(message_of(count, type, peer, comm));
  return PMPI_Bsend(data, count, type, peer, tag, comm);
}

extern "C" int MPI_Isend(const void* data, int count, MPI_Datatype type, int peer, int tag, MPI_Comm comm,
                         MPI_Request* request) {
  send(message_of(count, type, peer, comm));
  return PMPI_Isend(data, count, type, peer, tag, comm, request);
}

extern "C" int MPI_Issend(const void* data, int count, MPI_Datatype type, int peer, int tag, MPI_Comm comm,
                          MPI_Request* request) {
  send(message_of(count, type, peer, comm));
  return PMPI_Issend(data, count, type, peer, tag, comm, request);
}

extern "C" int MPI_Irsend(const void* data, int count, MPI_Datatype type, int peer, int tag, MPI_Comm comm,
                          MPI_Request* request) {
  send(message_of(count, type, peer, comm));
  return PMPI_Irsend(data, count, type, peer, tag, comm, request);
}

extern "C" int MPI_Ibsend(const void* data, int count, MPI_Datatype type, int peer, int tag, MPI_Comm comm,
                          MPI_Request* request) {
  send(message_of(count, type, peer, comm));
  return PMPI_Ibsend(data, count, type, peer, tag, comm, request);
}

extern "C" int MPI_Send_init(const void* data, int count, MPI_Datatype type, int peer, int tag, MPI_Comm comm,
                             MPI_Request* request) {
  return persistent(message_of(count, type, peer, comm), request,
                    [&] { return PMPI_Send_init(data, count, type, peer, tag, comm, request); });
}

extern "C" int MPI_Ssend_init(const void* data, int count, MPI_Datatype type, int peer, int tag,
                              MPI_Comm comm, MPI_Request* request) {
  return persistent(message_of(count, type, peer, comm), request,
                    [&] { return PMPI_Ssend_init(data, count, type, peer, tag, comm, request); });
}

extern "C" int MPI_Rsend_init(const void* data, int count, MPI_Datatype type, int peer, int tag,
                              MPI_Comm comm, MPI_Request* request) {
  return persistent(message_of(count, type, peer, comm), request,
                    [&] { return PMPI_Rsend_init(data, count, type, peer, tag, comm, request); });
}

extern "C" int MPI_Bsend_init(const void* data, int count, MPI_Datatype type, int peer, int tag,
                              MPI_Comm comm, MPI_Request* request) {
  return persistent(message_of(count, type, peer, comm), request,
                    [&] { return PMPI_Bsend_init(data, count, type, peer, tag, comm, request); });
}

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

extern "C" int MPI_Wait(MPI_Request* request, MPI_Status* status) {
  return timed(tally().waited, [&] { return PMPI_Wait(request, status); });
}

extern "C" int MPI_Waitall(int count, MPI_Request* requests, MPI_Status* statuses) {
  return timed(tally().waited, [&] { return PMPI_Waitall(count, requests, statuses); });
}

extern "C" int MPI_Waitany(int count, MPI_Request* requests, int* which, MPI_Status* status) {
  return timed(tally().waited, [&] { return PMPI_Waitany(count, requests, which, status); });
}

extern "C" int MPI_Waitsome(int count, MPI_Request* requests, int* done, int* which, MPI_Status* statuses) {
  return timed(tally().waited, [&] { return PMPI_Waitsome(count, requests, done, which, statuses); });
}

extern "C" int MPI_Recv(void* data, int count, MPI_Datatype type, int peer, int tag, MPI_Comm comm,
                        MPI_Status* status) {
  return timed(tally().waited, [&] { return PMPI_Recv(data, count, type, peer, tag, comm, status); });
}

extern "C" int MPI_Probe(int peer, int tag, MPI_Comm comm, MPI_Status* status) {
  return timed(tally().waited, [&] { return PMPI_Probe(peer, tag, comm, status); });
}

extern "C" int MPI_Mprobe(int peer, int tag, MPI_Comm comm, MPI_Message* message, MPI_Status* status) {
  return timed(tally().waited, [&] { return PMPI_Mprobe(peer, tag, comm, message, status); });
}

extern "C" int MPI_Mrecv(void* data, int count, MPI_Datatype type, MPI_Message* message, MPI_Status* status) {
  return timed(tally().waited, [&] { return PMPI_Mrecv(data, count, type, message, status); });
}

extern "C" int MPI_Allreduce(const void* data, void* got, int count, MPI_Datatype type, MPI_Op op,
                             MPI_Comm comm) {
  return collective("allreduce", comm, [&] { return PMPI_Allreduce(data, got, count, type, op, comm); });
}

extern "C" int MPI_Iallreduce(const void* data, void* got, int count, MPI_Datatype type, MPI_Op op,
                              MPI_Comm comm, MPI_Request* request) {
  return collective("allreduce", comm,
                    [&] { return PMPI_Iallreduce(data, got, count, type, op, comm, request); });
}

extern "C" int MPI_Reduce(const void* data, void* got, int count, MPI_Datatype type, MPI_Op op, int root,
                          MPI_Comm comm) {
  return collective("reduce", comm, [&] { return PMPI_Reduce(data, got, count, type, op, root, comm); });
}

extern "C" int MPI_Scan(const void* data, void* got, int count, MPI_Datatype type, MPI_Op op, MPI_Comm comm) {
  return collective("scan", comm, [&] { return PMPI_Scan(data, got, count, type, op, comm); });
}

extern "C" int MPI_Exscan(const void* data, void* got, int count, MPI_Datatype type, MPI_Op op,
                          MPI_Comm comm) {
  return collective("scan", comm, [&] { return PMPI_Exscan(data, got, count, type, op, comm); });
}

extern "C" int MPI_Reduce_scatter_block(const void* data, void* got, int count, MPI_Datatype type, MPI_Op op,
                                        MPI_Comm comm) {
  return collective("reduce_scatter", comm,
                    [&] { return PMPI_Reduce_scatter_block(data, got, count, type, op, comm); });
}

extern "C" int MPI_Reduce_scatter(const void* data, void* got, const int* counts, MPI_Datatype type,
                                  MPI_Op op, MPI_Comm comm) {
  return collective("reduce_scatter", comm,
                    [&] { return PMPI_Reduce_scatter(data, got, counts, type, op, comm); });
}

extern "C" int MPI_Barrier(MPI_Comm comm) {
  return collective("barrier", comm, [&] { return PMPI_Barrier(comm); });
}

extern "C" int MPI_Ibarrier(MPI_Comm comm, MPI_Request* request) {
  return collective("barrier", comm, [&] { return PMPI_Ibarrier(comm, request); });
}

extern "C" int MPI_Bcast(void* data, int count, MPI_Datatype type, int root, MPI_Comm comm) {
  return collective("bcast", comm, [&] { return PMPI_Bcast(data, count, type, root, comm); });
}

extern "C" int MPI_Ibcast(void* data, int count, MPI_Datatype type, int root, MPI_Comm comm,
                          MPI_Request* request) {
  return collective("bcast", comm, [&] { return PMPI_Ibcast(data, count, type, root, comm, request); });
}

extern "C" int MPI_Gather(const void* data, int count, MPI_Datatype type, void* got, int got_count,
                          MPI_Datatype got_type, int root, MPI_Comm comm) {
  return collective("gather", comm,
                    [&] { return PMPI_Gather(data, count, type, got, got_count, got_type, root, comm); });
}

extern "C" int MPI_Igather(const void* data, int count, MPI_Datatype type, void* got, int got_count,
                           MPI_Datatype got_type, int root, MPI_Comm comm, MPI_Request* r) {
  return collective("gather", comm,
                    [&] { return PMPI_Igather(data, count, type, got, got_count, got_type, root, comm, r); });
}

extern "C" int MPI_Gatherv(const void* data, int count, MPI_Datatype type, void* got, const int* counts,
                           const int* places, MPI_Datatype got_type, int root, MPI_Comm comm) {
  return collective("gather", comm, [&] {
    return PMPI_Gatherv(data, count, type, got, counts, places, got_type, root, comm);
  });
}

extern "C" int MPI_Igatherv(const void* data, int count, MPI_Datatype type, void* got, const int* counts,
                            const int* places, MPI_Datatype got_type, int root, MPI_Comm comm,
                            MPI_Request* r) {
  return collective("gather", comm, [&] {
    return PMPI_Igatherv(data, count, type, got, counts, places, got_type, root, comm, r);
  });
}

extern "C" int MPI_Scatter(const void* data, int count, MPI_Datatype type, void* got, int got_count,
                           MPI_Datatype got_type, int root, MPI_Comm comm) {
  return collective("scatter", comm,
                    [&] { return PMPI_Scatter(data, count, type, got, got_count, got_type, root, comm); });
}

extern "C" int MPI_Scatterv(const void* data, const int* counts, const int* places, MPI_Datatype type,
                            void* got, int count, MPI_Datatype got_type, int root, MPI_Comm comm) {
  return collective("scatter", comm, [&] {
    return PMPI_Scatterv(data, counts, places, type, got, count, got_type, root, comm);
  });
}

extern "C" int MPI_Allgather(const void* data, int count, MPI_Datatype type, void* got, int got_count,
                             MPI_Datatype got_type, MPI_Comm comm) {
  return collective("allgather", comm,
                    [&] { return PMPI_Allgather(data, count, type, got, got_count, got_type, comm); });
}

extern "C" int MPI_Allgatherv(const void* data, int count, MPI_Datatype type, void* got, const int* counts,
                              const int* places, MPI_Datatype got_type, MPI_Comm comm) {
  return collective("allgather", comm,
                    [&] { return PMPI_Allgatherv(data, count, type, got, counts, places, got_type, comm); });
}

extern "C" int MPI_Alltoall(const void* data, int count, MPI_Datatype type, void* got, int got_count,
                            MPI_Datatype got_type, MPI_Comm comm) {
  return collective("alltoall", comm,
                    [&] { return PMPI_Alltoall(data, count, type, got, got_count, got_type, comm); });
}

extern "C" int MPI_Alltoallv(const void* data, const int* counts, const int* places, MPI_Datatype type,
                             void* got, const int* got_counts, const int* got_places, MPI_Datatype got_type,
                             MPI_Comm comm) {
  return collective("alltoall", comm, [&] {
    return PMPI_Alltoallv(data, counts, places, type, got, got_counts, got_places, got_type, comm);
  });
}

extern "C" int MPI_Neighbor_alltoallv(const void* data, const int* counts, const int* places,
                                      MPI_Datatype type, void* got, const int* got_counts,
                                      const int* got_places, MPI_Datatype got_type, MPI_Comm comm) {
  return collective("neighbour", comm, [&] {
    return PMPI_Neighbor_alltoallv(data, counts, places, type, got, got_counts, got_places, got_type, comm);
  });
}

extern "C" int MPI_Finalize() {
  write();
  return PMPI_Finalize();
}
