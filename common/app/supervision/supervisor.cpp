// SPDX-License-Identifier: Apache-2.0
#include "common/app/supervision/supervisor.hpp"

#include <fcntl.h>
#include <sys/mman.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <chrono>
#include <condition_variable>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <mutex>
#include <sstream>
#include <thread>
#include <vector>

#include "common/app/supervision/board.hpp"
#include "common/base/error.hpp"
#include "common/coupling/wait.hpp"
#include "common/log/progress.hpp"
#include "common/parallel/collective.hpp"

namespace couplet::app {

using namespace watching;

namespace {

/// Returns true if a healthy job is asked to end during its steps: no process is gone or ending.
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
  // are gone. Guests do not come here. The one whose death the launcher has noticed is buried; those that it
  // ends therefore seldom are yet, and where two are, both are named.
  board.slots[board.mine].terminating = 1;
  const char* separator = "couplet: ";
  Line line;
  bool any = false, any_of_ours = false;
  for (int i = 0; i < board.count; ++i) {
    const Slot& slot = board.slots[i];
    if (slot.ending) return;
    if (i == board.mine || slot.finished || slot.terminating ||
        (slot.guest ? any_of_ours || state_of(slot.pid) != 'X' : !gone(slot.pid)))
      continue;
    any = true;
    if (!slot.guest) any_of_ours = true;
    line << separator;
    describe(line, slot, "was killed or has ended unexpectedly");
    separator = slot.guest ? ", or " : "; ";
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
  // Standard error is a pipe to the launcher, so the line needs time before the process exits: of 25 lines on a busy machine
  // 3 were lost after 0.02 s, 1 to 3 after 0.1 s, 0 or 1 after 0.6 s. Open MPI kills what is left after 1 s.
  timespec pause{0, 600'000'000};
  ::nanosleep(&pause, nullptr);
  ::_exit(128 + SIGTERM);
}

Slot* share_page(MPI_Comm machine, int rank, int slots) {
  const std::size_t bytes = sizeof(Slot) * std::size_t(slots);
  std::string path = fmt::format("/couplet-{}", ::getpid());
  parallel::broadcast(machine, path);
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
  // Without shared memory the job runs normally, but without the line about dead processes.
  if (parallel::any(machine, page == MAP_FAILED)) return nullptr;
  return static_cast<Slot*>(page);
}

}  // namespace

const char* name(Phase phase) {
  constexpr std::array names{"roll-call", "initialise", "waiting", "begin_step", "solve",
                             "accept",    "output",     "save",    "load",       "finalise"};
  static_assert(names.size() == std::size_t(Phase::finalise) + 1);
  return names[std::size_t(phase)];
}

Supervisor::Supervisor(MPI_Comm world, const std::string& participant) {
  MPI_Comm machine;
  MPI_Comm_split_type(world, MPI_COMM_TYPE_SHARED, parallel::comm_rank(world), MPI_INFO_NULL, &machine);
  board.count = parallel::comm_size(machine);
  board.mine = parallel::comm_rank(machine);
  board.whole_job = board.count == parallel::comm_size(world);
  const int guests = parallel::comm_size(MPI_COMM_WORLD) - parallel::comm_size(world);
  board.has_guests = guests > 0;
  Slot* slots = share_page(machine, board.mine, board.count + guests);
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
  if (slots) log::listen_for_life({&slots[board.mine].alive, &slots[board.mine].long_work});
  watch_waits();
  install();
}

void Supervisor::install() {
  if (board.slots == nullptr) return;
  struct sigaction action {};
  action.sa_handler = on_terminate;
  sigaction(SIGTERM, &action, nullptr);
}

void Supervisor::set_rank(int rank) {
  if (board.slots) board.slots[board.mine].rank = rank;
}

/// Each process of the machine writes the same.
void Supervisor::add_guest(const std::string& participant, const std::string& process) {
  char machine[256] = "";
  ::gethostname(machine, sizeof machine - 1);
  const std::size_t at = process.find('@');
  const int pid = std::atoi(process.c_str());
  if (!board.slots || at == std::string::npos || process.substr(at + 1) != machine || pid <= 0 || gone(pid))
    return;
  Slot& slot = board.slots[board.count];
  std::strncpy(slot.participant, participant.c_str(), sizeof slot.participant - 1);
  slot.rank = -1;
  slot.phase = int(Phase::waiting);  // its signs of life are its own affair
  slot.guest = 1;
  slot.pid = pid;
  ++board.count;
}

void Supervisor::enter(Phase phase) {
  phase_ = phase;
  if (!board.slots) return;
  if (phase == Phase::finalise)  // guests may be gone from now on
    for (int i = 0; i < board.count; ++i)
      if (board.slots[i].guest) board.slots[i].finished = 1;
  board.slots[board.mine].phase = int(phase);
  board.slots[board.mine].alive = now();
}

void Supervisor::set_time(double time) {
  if (board.slots) board.slots[board.mine].time = time;
}

void Supervisor::limit_silence(double seconds) {
  if (!board.slots || seconds <= 0 || board.count < 2) return;
  guard_ = std::jthread([seconds](const std::stop_token& stop) {
    // Signals are handled by the main thread.
    sigset_t all;
    sigfillset(&all);
    pthread_sigmask(SIG_BLOCK, &all, nullptr);
    Listener listener(seconds);
    std::mutex mutex;
    std::condition_variable_any bell;
    std::unique_lock lock(mutex);
    const std::chrono::duration<double> period(listener.period());
    while (!bell.wait_for(lock, stop, period, [&] { return stop.stop_requested(); })) listener.check();
  });
}

bool Supervisor::stop_requested() { return board.slots && board.slots[0].stop_requested; }

void Supervisor::stopped() {
  if (board.slots) board.slots[0].stopped = 1;
}

bool Supervisor::has_stopped() { return board.slots && board.slots[0].stopped; }

bool Supervisor::claim_report() {
  if (!board.slots) return true;
  for (int i = 0; i < board.count; ++i)
    if (std::strcmp(board.slots[i].participant, board.slots[board.mine].participant) == 0)
      return board.slots[i].reported.exchange(1) == 0;
  return true;
}

void Supervisor::ending() {
  if (board.slots) board.slots[board.mine].ending = 1;
}

void Supervisor::finished() {
  if (board.slots) board.slots[board.mine].finished = 1;
  // A launcher that clears up after another process's exit code must not spoil this one's.
  std::signal(SIGTERM, SIG_IGN);
}

FaultInjection::FaultInjection(std::string_view participant, int rank) {
  const char* text = std::getenv("COUPLET_FAULT");
  if (text == nullptr) return;
  std::vector<std::string> parts;
  std::istringstream in(text);
  for (std::string part; std::getline(in, part, ':');) parts.push_back(part);
  if (parts.size() < 3 || parts[0] != participant) return;
  if ((parts.size() > 3 ? std::atoi(parts[3].c_str()) : 0) != rank) return;
  armed_ = true;
  phase_ = parts[1];
  remaining_ = std::atoi(parts[2].c_str());
  fate_ = parts.size() > 4 ? parts[4] : "kill";
}

void FaultInjection::at(std::string_view phase) {
  if (!armed_ || phase != phase_ || --remaining_ != 0) return;
  using namespace std::chrono_literals;
  if (fate_ == "kill") std::raise(SIGKILL);
  if (fate_ == "stop") std::raise(SIGSTOP);
  while (fate_ == "hang") std::this_thread::sleep_for(1s);
  coupling::PoliteWait wait("a message that is never sent");
  while (fate_ == "wait") wait.pause();
  for (int i = 0; fate_ == "work" && i < 140; ++i) {
    std::this_thread::sleep_for(50ms);
    log::alive();
  }
}

namespace {

/// Text "fluid_solver (pid 7)" with other stopped children of the launcher, or empty.
std::string stopped_ones() {
  const std::string launcher = std::to_string(::getppid());
  std::ifstream children("/proc/" + launcher + "/task/" + launcher + "/children");
  std::string names;
  for (int pid = 0; children >> pid;) {
    if (pid == ::getpid() || watching::state_of(pid) != 'T') continue;
    std::error_code unknown;
    const auto program = std::filesystem::read_symlink("/proc/" + std::to_string(pid) + "/exe", unknown);
    names += (names.empty() ? "" : ", ") + program.filename().string() + " (pid " + std::to_string(pid) + ")";
  }
  return names;
}

}  // namespace

StartDeadline::StartDeadline(double seconds, std::string label) {
  if (!(seconds > 0)) return;
  guard_ = std::jthread([seconds, label = std::move(label)](const std::stop_token& stop) {
    sigset_t all;  // signals are handled by the main thread
    sigfillset(&all);
    pthread_sigmask(SIG_BLOCK, &all, nullptr);
    std::mutex mutex;
    std::condition_variable_any bell;
    std::unique_lock lock(mutex);
    bell.wait_for(lock, stop, std::chrono::duration<double>(seconds), [] { return false; });
    if (stop.stop_requested()) return;
    const std::string stopped = stopped_ones();
    std::ostringstream text;
    text << "[" << label << "] error: not all programs of this job have answered within " << seconds
         << " s of the start (simulation.hang-timeout): "
         << (stopped.empty() ? "one of them hangs or was not started" : "stopped (as by SIGSTOP): " + stopped)
         << ". The job ends.\n";
    std::cerr << text.str() << std::flush;
    ::_exit(1);  // the launcher ends the others, including stopped ones
  });
}

}  // namespace couplet::app
