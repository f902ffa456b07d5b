// SPDX-License-Identifier: Apache-2.0
#include "common/coupling/wait.hpp"

#include <sched.h>

#include <algorithm>
#include <thread>

#include "common/base/error.hpp"
#include "common/log/log.hpp"
#include "common/parallel/collective.hpp"

namespace couplet::coupling {
namespace {

WaitObserver& observer() {
  static WaitObserver one;
  return one;
}

}  // namespace

void observe_waits(const WaitObserver& one) { observer() = one; }

PoliteWait::~PoliteWait() {
  if (reported_) observer().over();
}

void PoliteWait::pause() {
  using namespace std::chrono_literals;
  const std::chrono::duration<double> waited = Clock::now() - start_;
  if (waited < 80us) {
    sched_yield();
    return;
  }
  std::this_thread::sleep_for(std::min<std::chrono::duration<double>>(waited / 16, 250us));
  if (waited > report_ && observer().lasts) {
    report_ = waited + 250ms;
    reported_ = true;
    observer().lasts(what_.c_str());
  }
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

namespace {

MPI_Message await_message(MPI_Comm peers, int from, int tag, const std::string& what, MPI_Status& status) {
  PoliteWait wait(what);
  MPI_Message message;
  for (int there = 0;;) {
    MPI_Improbe(from, tag, peers, &there, &message, &status);
    if (there) return message;
    wait.pause();
  }
}

}  // namespace

std::vector<char> receive_bytes(MPI_Comm peers, int from, int tag, const std::string& what,
                                std::size_t most) {
  MPI_Status status;
  MPI_Message message = await_message(peers, from, tag, what, status);
  int count = 0;
  MPI_Get_count(&status, MPI_BYTE, &count);
  // MPI counts up to 2^31 - 1; beyond that the count is undefined.
  if (count < 0 || std::size_t(count) > most)
    throw Error("While waiting for {}: received a message of {} bytes; expected at most {}.", what, count,
                most);
  std::vector<char> bytes(static_cast<std::size_t>(count));
  MPI_Request request;
  MPI_Imrecv(bytes.data(), count, MPI_BYTE, &message, &request);
  wait_politely(request, what);
  return bytes;
}

namespace {

/// Segments as one MPI datatype relative to MPI_BOTTOM. A single segment uses the type of its values.
template <class Value>
class Layout {
 public:
  explicit Layout(const std::vector<std::span<Value>>& parts) {
    if (parts.size() == 1) {
      at_ = const_cast<double*>(parts[0].data()), count_ = int(parts[0].size());
      return;
    }
    std::vector<int> lengths;
    std::vector<MPI_Aint> places;
    for (const auto& part : parts) {
      lengths.push_back(int(part.size()));
      MPI_Get_address(part.data(), &places.emplace_back());
    }
    MPI_Type_create_hindexed(int(parts.size()), lengths.data(), places.data(), MPI_DOUBLE, &type_);
    MPI_Type_commit(&type_);
  }
  ~Layout() {
    // MPI keeps the type until pending messages are completed.
    if (type_ != MPI_DOUBLE) MPI_Type_free(&type_);
  }
  Layout(const Layout&) = delete;
  void* at() const { return at_; }
  int count() const { return count_; }
  MPI_Datatype type() const { return type_; }

 private:
  void* at_ = MPI_BOTTOM;
  int count_ = 1;
  MPI_Datatype type_ = MPI_DOUBLE;
};

}  // namespace

void receive_stretches(MPI_Comm peers, int from, int tag, const Stretches& to, const std::string& what) {
  const Layout<double> layout(to);
  std::size_t wanted = 0;
  for (const auto& part : to) wanted += part.size();
  MPI_Status status;
  MPI_Message message = await_message(peers, from, tag, what, status);
  int bytes = 0;
  MPI_Get_count(&status, MPI_BYTE, &bytes);
  // A foreign program may send another size than it announced.
  if (std::size_t(bytes) != wanted * sizeof(double))
    throw Error("While waiting for {}: received a message of {} values; {} were announced.", what,
                std::size_t(bytes) / sizeof(double), wanted);
  MPI_Request request;
  MPI_Imrecv(layout.at(), layout.count(), layout.type(), &message, &request);
  wait_politely(request, what);
}

void SendAll::add(int to, int tag, const std::vector<std::span<const double>>& values) {
  const Layout<const double> layout(values);
  MPI_Isend(layout.at(), layout.count(), layout.type(), to, tag, peers_, &requests_.emplace_back());
}

void SendAll::wait(const std::string& what) {
  for (MPI_Request& request : requests_) wait_politely(request, what);
  requests_.clear();
}

void broadcast_bytes(MPI_Comm comm, std::vector<char>& bytes, const std::string& what) {
  if (parallel::comm_size(comm) == 1) return;
  MPI_Request request;
  auto length = static_cast<GlobalIndex>(bytes.size());
  MPI_Ibcast(&length, 1, MPI_INT64_T, 0, comm, &request);
  wait_politely(request, what);
  bytes.resize(length);
  MPI_Ibcast(bytes.data(), static_cast<int>(length), MPI_BYTE, 0, comm, &request);
  wait_politely(request, what);
}

}  // namespace couplet::coupling
