// SPDX-License-Identifier: Apache-2.0
#include "common/coupling/wait.hpp"

#include <sched.h>

#include <algorithm>
#include <thread>

#include "common/log/log.hpp"
#include "common/parallel/collective.hpp"

namespace couplet {

void PoliteWait::pause() {
  using namespace std::chrono_literals;
  const std::chrono::duration<double> waited = Clock::now() - start_;
  if (waited < 80us) {
    sched_yield();
    return;
  }
  std::this_thread::sleep_for(std::min<std::chrono::duration<double>>(waited / 8, 500us));
  if (waited > notice_ && !what_.empty()) {
    log::info("waiting for {} for {:.0f} s", what_, waited.count());
    notice_ *= 2;
  }
}

void wait_politely(MPI_Request& request, const std::string& what) {
  PoliteWait wait(what);
  for (int done = 0;;) {
    MPI_Test(&request, &done, MPI_STATUS_IGNORE);
    if (done) return;
    wait.pause();
  }
}

void send_bytes(MPI_Comm peers, int to, int tag, std::span<const char> bytes, const std::string& what) {
  MPI_Request request;
  MPI_Isend(bytes.data(), static_cast<int>(bytes.size()), MPI_BYTE, to, tag, peers, &request);
  wait_politely(request, what);
}

std::vector<char> receive_bytes(MPI_Comm peers, int from, int tag, const std::string& what) {
  PoliteWait wait(what);
  MPI_Message message;
  MPI_Status status;
  for (int there = 0;;) {
    MPI_Improbe(from, tag, peers, &there, &message, &status);
    if (there) break;
    wait.pause();
  }
  int count = 0;
  MPI_Get_count(&status, MPI_BYTE, &count);
  std::vector<char> bytes(count);
  MPI_Request request;
  MPI_Imrecv(bytes.data(), count, MPI_BYTE, &message, &request);
  wait_politely(request, what);
  return bytes;
}

std::vector<double> receive_doubles(MPI_Comm peers, int from, int tag, std::size_t count,
                                    const std::string& what) {
  std::vector<double> values(count);
  MPI_Request request;
  MPI_Irecv(values.data(), static_cast<int>(count), MPI_DOUBLE, from, tag, peers, &request);
  wait_politely(request, what);
  return values;
}

void SendAll::add(int to, int tag, std::vector<double> values) {
  values_.push_back(std::move(values));
  MPI_Isend(values_.back().data(), static_cast<int>(values_.back().size()), MPI_DOUBLE, to, tag, peers_,
            &requests_.emplace_back());
}

void SendAll::wait(const std::string& what) {
  for (MPI_Request& request : requests_) wait_politely(request, what);
  requests_.clear();
  values_.clear();
}

void broadcast_bytes(MPI_Comm comm, std::vector<char>& bytes, const std::string& what) {
  if (comm_size(comm) == 1) return;
  MPI_Request request;
  auto length = static_cast<GlobalIndex>(bytes.size());
  MPI_Ibcast(&length, 1, MPI_INT64_T, 0, comm, &request);
  wait_politely(request, what);
  bytes.resize(length);
  MPI_Ibcast(bytes.data(), static_cast<int>(length), MPI_BYTE, 0, comm, &request);
  wait_politely(request, what);
}

}  // namespace couplet
