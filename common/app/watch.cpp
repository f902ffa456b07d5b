// SPDX-License-Identifier: Apache-2.0
#include "common/app/watch.hpp"

#include <fcntl.h>
#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <chrono>
#include <condition_variable>
#include <csignal>
#include <cstring>
#include <ctime>
#include <mutex>
#include <string_view>
#include <vector>

#include "common/base/error.hpp"
#include "common/parallel/collective.hpp"

namespace couplet {
namespace {

struct Slot {
  char participant[64];
  std::atomic<int> pid, rank, phase, ending, finished, terminating, reported, spoke_for_all;
  std::atomic<int> stop_requested, stopped;  // of the job: in the first slot
  std::atomic<double> time;
  std::atomic<double> alive;  // last sign of life [s] on the machine's steady clock
};
static_assert(std::atomic<int>::is_always_lock_free && std::atomic<double>::is_always_lock_free);

// A signal handler can only reach what has static storage. Written once, before the handler is installed.
struct Board {
  Slot* slots = nullptr;  // one a process of this machine, by world rank
  int count = 0;
  int mine = 0;
  bool whole_job = false;  // all processes of the job are on this machine
};
Board board;  // NOLINT: see above

/// Text built without allocation, for the signal handler.
class Line {
 public:
  Line& operator<<(std::string_view text) {
    for (const char c : text)
      if (size_ < sizeof text_) text_[size_++] = c;
    return *this;
  }
  Line& operator<<(long value) {
    char digits[24];
    int n = 0;
    if (value < 0) *this << "-";
    for (unsigned long v = value < 0 ? -value : value; n == 0 || v > 0; v /= 10)
      digits[n++] = char('0' + v % 10);
    while (n > 0) *this << std::string_view(&digits[--n], 1);
    return *this;
  }
  /// Six decimals, none for whole numbers.
  Line& operator<<(double value) {
    if (value == double(long(value))) return *this << long(value);
    const auto micro = static_cast<long>(value * 1e6 + 0.5);
    *this << micro / 1000000 << ".";
    for (long digit = 100000; digit > 0; digit /= 10) *this << micro / digit % 10;
    return *this;
  }
  const char* text() const { return text_; }
  bool empty() const { return size_ == 0; }
  void write_to(int file) const {
    for (std::size_t done = 0; done < size_;) {
      const ssize_t n = ::write(file, text_ + done, size_ - done);
      if (n <= 0) return;
      done += std::size_t(n);
    }
  }

 private:
  char text_[1000];
  std::size_t size_ = 0;
};

double now() {
  timespec t{};
  ::clock_gettime(CLOCK_MONOTONIC, &t);
  return double(t.tv_sec) + 1e-9 * double(t.tv_nsec);
}

/// The letter of the process in /proc: R running, S sleeping, T stopped, Z waiting to be buried; X: there is none.
char state_of(int pid) {
  if (::kill(pid, 0) != 0 && errno == ESRCH) return 'X';
  Line path;
  path << "/proc/" << long(pid) << "/stat" << std::string_view("\0", 1);
  const int file = ::open(path.text(), O_RDONLY);
  if (file < 0) return 'X';
  char text[512];
  const ssize_t size = ::read(file, text, sizeof text);
  ::close(file);
  // "pid (program) state ...", where the program's name may hold anything but ends at the last bracket.
  for (ssize_t i = size - 1; i >= 0; --i)
    if (text[i] == ')' && i + 2 < size) return text[i + 2];
  return 'R';
}

/// No such process, or one that only waits to be buried.
bool gone(int pid) {
  const char state = state_of(pid);
  return state == 'Z' || state == 'X';
}

void describe(Line& line, const Slot& slot, std::string_view fate) {
  line << "participant '" << slot.participant << "'";
  if (slot.rank >= 0)
    line << " (rank " << long(slot.rank) << ", pid " << long(slot.pid) << ")";
  else
    line << " (pid " << long(slot.pid) << ")";
  line << " " << fate << "; last heard of in " << name(Phase(slot.phase.load()));
  if (slot.time >= 0) line << " at t = " << slot.time.load() << " s";
}

/// Whether somebody wants the job to end although all of it is well and making steps: nobody is gone, nobody ends.
bool is_a_wish() {
  if (board.slots[board.mine].phase <= int(Phase::initialise)) return false;
  for (int i = 0; i < board.count; ++i) {
    const Slot& slot = board.slots[i];
    if (slot.ending || slot.terminating || (!slot.finished && gone(slot.pid))) return false;
  }
  return true;
}

void report_the_dead() {
  // The launcher may end the survivors one by one: those that have come here are no culprits, even if they
  // are gone.
  board.slots[board.mine].terminating = 1;
  const char* separator = "couplet: ";
  Line line;
  bool any = false;
  for (int i = 0; i < board.count; ++i) {
    const Slot& slot = board.slots[i];
    if (slot.ending) return;
    if (i == board.mine || slot.finished || slot.terminating || !gone(slot.pid)) continue;
    any = true;
    line << separator;
    describe(line, slot, "was killed or has ended unexpectedly");
    separator = "; ";
  }
  if (!any && !board.whole_job) return;
  if (!any) line << "couplet: the job was stopped from outside (signal SIGTERM)";
  line << ". All programs of the job end.\n";
  // One line for all: that of the first survivor to come here.
  if (board.slots[0].spoke_for_all.exchange(1) == 0) line.write_to(STDERR_FILENO);
}

extern "C" void on_terminate(int) {
  const int error = errno;
  if (is_a_wish()) {
    board.slots[0].stop_requested = 1;
    errno = error;
    return;
  }
  report_the_dead();
  // Standard error is a pipe to the launcher: the line shall be through before the process is gone.
  timespec pause{0, 100'000'000};
  ::nanosleep(&pause, nullptr);
  ::_exit(128 + SIGTERM);
}

/// What one process notices of the others' silence, look by look.
class Listener {
 public:
  explicit Listener(double patience) : patience_(patience), asleep_since_(std::size_t(board.count), 0.) {}

  /// Ends the job if a process is silent: it is stopped, or nothing has been heard of it although it is not one that
  /// waits. The coupler waits inside its other phases: it is named only if nobody else can be.
  void look() {
    const double t = now();
    // Whoever was stopped himself has heard nothing of anybody.
    if (t - last_look_ > 1) {
      started_ = t;
      std::fill(asleep_since_.begin(), asleep_since_.end(), 0.);
    }
    last_look_ = t;
    bool any_asleep = false, any_drowsy = false, any_busy = false;
    for (int i = 0; i < board.count; ++i) {
      const Slot& slot = board.slots[i];
      if (slot.ending || slot.terminating) return;
      double& since = asleep_since_[std::size_t(i)];
      if (i == board.mine || slot.finished || state_of(slot.pid) != 'T')
        since = 0;
      else if (since == 0)
        since = t;
      any_asleep = any_asleep || is_asleep(i);
      any_drowsy = any_drowsy || since > 0;
      any_busy = any_busy || (is_silent(i) && !is_coupler(slot));
    }
    // Others wait for one that is stopped: it is given its time before any of them is blamed.
    if (any_drowsy && !any_asleep) return;
    Line line;
    const char* separator = "couplet: ";
    for (int i = 0; i < board.count; ++i) {
      if (any_asleep ? !is_asleep(i) : !is_silent(i) || (is_coupler(board.slots[i]) && any_busy)) continue;
      line << separator;
      describe(line, board.slots[i], any_asleep ? "is stopped (as by SIGSTOP)" : "hangs");
      separator = "; ";
    }
    if (line.empty()) return;
    line << ". Nothing was heard of it for " << patience_
         << " s (simulation.hang-timeout). All programs of the job end.\n";
    if (board.slots[0].spoke_for_all.exchange(1) == 0) line.write_to(STDERR_FILENO);
    board.slots[board.mine].ending = 1;
    timespec pause{0, 100'000'000};
    ::nanosleep(&pause, nullptr);
    ::_exit(1);
  }

 private:
  static bool is_coupler(const Slot& slot) { return std::string_view(slot.participant) == "coupler"; }
  bool is_asleep(int i) const {
    const double since = asleep_since_[std::size_t(i)];
    return since > 0 && last_look_ - since > patience_;
  }
  bool is_silent(int i) const {
    const Slot& slot = board.slots[i];
    return i != board.mine && !slot.finished && slot.phase != int(Phase::waiting) &&
           last_look_ - std::max(started_, slot.alive.load()) > patience_;
  }
  double patience_, last_look_ = now(), started_ = now();
  std::vector<double> asleep_since_;  // 0: awake
};

Slot* share_page(MPI_Comm machine, int rank, int size) {
  const std::size_t bytes = sizeof(Slot) * std::size_t(size);
  std::string path = fmt::format("/couplet-{}", ::getpid());
  broadcast(machine, path);
  int file = -1;
  if (rank == 0) {
    file = ::shm_open(path.c_str(), O_CREAT | O_EXCL | O_RDWR, 0600);
    if (file >= 0 && ::ftruncate(file, off_t(bytes)) != 0) file = -1;
  }
  MPI_Barrier(machine);
  if (rank != 0) file = ::shm_open(path.c_str(), O_RDWR, 0600);
  void* page = file < 0 ? MAP_FAILED : ::mmap(nullptr, bytes, PROT_READ | PROT_WRITE, MAP_SHARED, file, 0);
  if (file >= 0) ::close(file);
  MPI_Barrier(machine);
  if (rank == 0) ::shm_unlink(path.c_str());
  // Without shared memory the job runs all the same; only the line about the dead is lost.
  if (any(machine, page == MAP_FAILED)) return nullptr;
  return static_cast<Slot*>(page);
}

}  // namespace

const char* name(Phase phase) {
  switch (phase) {
    case Phase::roll_call:
      return "roll-call";
    case Phase::initialise:
      return "initialise";
    case Phase::waiting:
      return "waiting";
    case Phase::begin_step:
      return "begin_step";
    case Phase::solve:
      return "solve";
    case Phase::accept:
      return "accept";
    case Phase::output:
      return "output";
    case Phase::save:
      return "save";
    case Phase::load:
      return "load";
    case Phase::finalise:
      return "finalise";
  }
  return "an unknown phase";
}

Watch::Watch(MPI_Comm world, const std::string& participant) {
  MPI_Comm machine;
  MPI_Comm_split_type(world, MPI_COMM_TYPE_SHARED, comm_rank(world), MPI_INFO_NULL, &machine);
  board.count = comm_size(machine);
  board.mine = comm_rank(machine);
  board.whole_job = board.count == comm_size(world);
  Slot* slots = share_page(machine, board.mine, board.count);
  if (slots != nullptr) {
    Slot& slot = slots[board.mine];
    std::strncpy(slot.participant, participant.c_str(), sizeof slot.participant - 1);
    slot.rank = -1;
    slot.time = -1;
    slot.phase = int(Phase::roll_call);
    slot.alive = now();
    slot.pid = ::getpid();
  }
  MPI_Barrier(machine);
  MPI_Comm_free(&machine);
  board.slots = slots;
  install();
}

void Watch::install() {
  if (board.slots == nullptr) return;
  struct sigaction action {};
  action.sa_handler = on_terminate;
  sigaction(SIGTERM, &action, nullptr);
}

void Watch::set_rank(int rank) {
  if (board.slots) board.slots[board.mine].rank = rank;
}

void Watch::enter(Phase phase) {
  phase_ = phase;
  if (!board.slots) return;
  board.slots[board.mine].phase = int(phase);
  board.slots[board.mine].alive = now();
}

void Watch::set_time(double time) {
  if (board.slots) board.slots[board.mine].time = time;
}

void Watch::limit_silence(double seconds) {
  if (!board.slots || seconds <= 0 || board.count < 2) return;
  guard_ = std::jthread([seconds](const std::stop_token& stop) {
    // Signals are for the main thread.
    sigset_t all;
    sigfillset(&all);
    pthread_sigmask(SIG_BLOCK, &all, nullptr);
    Listener listener(seconds);
    std::mutex mutex;
    std::condition_variable_any bell;
    std::unique_lock lock(mutex);
    while (!bell.wait_for(lock, stop, std::chrono::milliseconds(50), [&] { return stop.stop_requested(); }))
      listener.look();
  });
}

bool Watch::stop_requested() { return board.slots && board.slots[0].stop_requested; }

void Watch::stopped() {
  if (board.slots) board.slots[0].stopped = 1;
}

bool Watch::has_stopped() { return board.slots && board.slots[0].stopped; }

bool Watch::claim_report() {
  if (!board.slots) return true;
  for (int i = 0; i < board.count; ++i)
    if (std::strcmp(board.slots[i].participant, board.slots[board.mine].participant) == 0)
      return board.slots[i].reported.exchange(1) == 0;
  return true;
}

void Watch::ending() {
  if (board.slots) board.slots[board.mine].ending = 1;
}

void Watch::finished() {
  if (board.slots) board.slots[board.mine].finished = 1;
  // A launcher that clears up after another process's exit code must not spoil this one's.
  std::signal(SIGTERM, SIG_IGN);
}

}  // namespace couplet
