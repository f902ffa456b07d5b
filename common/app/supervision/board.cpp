// SPDX-License-Identifier: Apache-2.0
#include "common/app/supervision/board.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <ctime>
#include <fstream>
#include <sstream>
#include <string>

#include "common/coupling/wait.hpp"

namespace couplet::app::watching {

Board board;  // NOLINT: see watch_board.hpp

double now() {
  timespec t{};
  ::clock_gettime(CLOCK_MONOTONIC, &t);
  return double(t.tv_sec) + 1e-9 * double(t.tv_nsec);
}

char state_of(int pid) {
  if (::kill(pid, 0) != 0 && errno == ESRCH) return 'X';
  Line path;
  path << "/proc/" << long(pid) << "/stat" << std::string_view("\0", 1);
  const int file = ::open(path.text(), O_RDONLY);
  if (file < 0) return 'X';
  char text[512];
  const ssize_t size = ::read(file, text, sizeof text);
  ::close(file);
  // Format "pid (program) state ...". The name may contain anything, so the last bracket ends it.
  for (ssize_t i = size - 1; i >= 0; --i)
    if (text[i] == ')' && i + 2 < size) return text[i + 2];
  return 'R';
}

bool gone(int pid) {
  const char state = state_of(pid);
  return state == 'Z' || state == 'X';
}

namespace {

/// User and system time of a process and its terminated children.
double own_seconds(const std::string& folder) {
  std::ifstream file(folder + "/stat");
  std::string text{std::istreambuf_iterator<char>(file), {}};
  const auto end = text.rfind(')');
  if (end == std::string::npos) return 0;
  std::istringstream fields(text.substr(end + 2));
  std::string skipped;
  for (int i = 0; i < 11; ++i) fields >> skipped;
  double total = 0, ticks = 0;
  for (int i = 0; i < 4 && fields >> ticks; ++i) total += ticks;
  return total / double(::sysconf(_SC_CLK_TCK));
}

/// Includes children and their children, because a program may be started by another one.
double seconds_of(const std::string& pid, int depth) {
  const std::string folder = "/proc/" + pid;
  double total = own_seconds(folder);
  std::ifstream children(folder + "/task/" + pid + "/children");
  for (std::string child; depth > 0 && children >> child;) total += seconds_of(child, depth - 1);
  return total;
}

}  // namespace

double processor_seconds_of(int pid) { return seconds_of(std::to_string(pid), 4); }

void describe(Line& line, const Slot& slot, std::string_view fate) {
  line << "participant '" << slot.participant << "'";
  if (slot.rank >= 0)
    line << " (rank " << long(slot.rank) << ", pid " << long(slot.pid) << ")";
  else
    line << " (pid " << long(slot.pid) << ")";
  line << " " << fate;
  if (slot.guest) return;
  line << "; last heard of in " << name(Phase(slot.phase.load()));
  if (slot.time >= 0) line << " at t = " << slot.time.load() << " s";
}

void end_job_with(const Line& line) {
  if (board.slots[0].spoke_for_all.exchange(1) == 0) line.write_to(STDERR_FILENO);
  board.slots[board.mine].ending = 1;
  timespec pause{0, 100'000'000};
  ::nanosleep(&pause, nullptr);
  ::_exit(1);
}

namespace {

constexpr double patience = 4;   // [s] without change while all wait, each for more than a second
constexpr double is_recent = 2;  // [s]: a waiting process polls four times per second

/// Start of the period in which all processes wait for the same as now, or 0 if not all do.
struct Stillness {
  double since = 0, sum = 0;  // sum: of the start times of the waits, to distinguish them from later ones
};

/// Sum of Stillness, or 0 if a process does not wait.
double all_wait(double t) {
  double sum = 0;
  for (int i = 0; i < board.count; ++i) {
    const Slot& slot = board.slots[i];
    if (slot.ending || slot.terminating) return 0;
    if (slot.finished) continue;
    if (slot.waits_since == 0 || t - slot.looked > is_recent) return 0;
    sum += slot.waits_since;
  }
  return sum;
}

[[noreturn]] void name_the_circle() {
  Line line;
  line << "couplet: deadlock: all programs of the job wait for each other: ";
  const char* separator = "";
  for (int i = 0; i < board.count; ++i) {
    const Slot& slot = board.slots[i];
    if (slot.finished || slot.rank > 0) continue;
    line << separator << "'" << slot.participant << "' waits for "
         << (slot.waits_for[0] ? slot.waits_for : "the next command");
    separator = "; ";
  }
  line << ". All programs of the job end.\n";
  std::fflush(nullptr);
  end_job_with(line);
}

void lasts(const char* what) {
  static Stillness still;
  Slot& slot = board.slots[board.mine];
  const double t = now();
  if (slot.waits_since == 0) {
    std::strncpy(slot.waits_for, what, sizeof slot.waits_for - 1);
    slot.waits_since = t;
  }
  slot.looked = slot.alive = t;
  if (!board.whole_job || board.has_guests || board.count < 2) return;
  const double sum = all_wait(t);
  if (sum == 0 || sum != still.sum)
    still = {t, sum};
  else if (t - still.since > patience)
    name_the_circle();
}

void over() { board.slots[board.mine].waits_since = 0; }

}  // namespace

void watch_waits() {
  if (board.slots) coupling::observe_waits({lasts, over});
}

namespace {

/// Smallest share of processor time since its last sign of life for which a process counts as busy.
constexpr double least_share = 1e-3, least_seconds = 0.02;

bool is_coupler(const Slot& slot) { return std::string_view(slot.participant) == "coupler"; }

/// Returns true if processor time is its sign of life.
bool works_long(const Slot& slot) {
  switch (Phase(slot.phase.load())) {
    case Phase::initialise:
    case Phase::output:
    case Phase::save:
    case Phase::load:
    case Phase::finalise:
      return true;
    default:
      return slot.long_work > 0;
  }
}

}  // namespace

Listener::Listener(double patience)
    : patience_(patience),
      period_(std::clamp(patience / 120, 0.05, 5.)),
      last_look_(now()),
      started_(last_look_),
      asleep_since_(std::size_t(board.count), 0.),
      work_(std::size_t(board.count)) {}

void Listener::check() {
  const double t = now();
  // A process that was itself stopped has heard nothing from the others.
  if (t - last_look_ > 1 + 2 * period_) {
    started_ = t;
    std::fill(asleep_since_.begin(), asleep_since_.end(), 0.);
  }
  last_look_ = t;
  bool any_asleep = false, any_drowsy = false, any_busy = false;
  for (int i = 0; i < board.count; ++i) {
    const Slot& slot = board.slots[i];
    if (slot.ending || slot.terminating) return;
    hear(i);
    any_asleep = any_asleep || is_asleep(i);
    any_drowsy = any_drowsy || asleep_since_[std::size_t(i)] > 0;
    any_busy = any_busy || (is_silent(i) && !is_coupler(slot));
  }
  // Others wait for a stopped process, so it gets its time before another one is blamed.
  if (any_drowsy && !any_asleep) return;
  speak(any_asleep, any_busy);
}

void Listener::hear(int i) {
  const Slot& slot = board.slots[i];
  double& asleep = asleep_since_[std::size_t(i)];
  if (i == board.mine || slot.finished || state_of(slot.pid) != 'T')
    asleep = 0;
  else if (asleep == 0)
    asleep = last_look_;
  WorkTime& work = work_[std::size_t(i)];
  if (i == board.mine || slot.finished || !works_long(slot)) {
    work.since = 0;
    return;
  }
  const double seconds = processor_seconds_of(slot.pid);
  // The sum decreases when a terminated child is not yet counted.
  if (work.since == 0 || seconds < work.seconds ||
      seconds - work.seconds > least_seconds + least_share * (last_look_ - work.since))
    work = {seconds, last_look_};
}

void Listener::speak(bool any_asleep, bool any_busy) const {
  Line line;
  const char* separator = "couplet: ";
  for (int i = 0; i < board.count; ++i) {
    if (any_asleep ? !is_asleep(i) : !is_silent(i) || (is_coupler(board.slots[i]) && any_busy)) continue;
    line << separator;
    describe(line, board.slots[i], any_asleep ? "is stopped (as by SIGSTOP)" : "hangs");
    separator = "; ";
  }
  if (line.empty()) return;
  line << ". No sign of life for " << patience_
       << " s (simulation.hang-timeout). All programs of the job end.\n";
  end_job_with(line);
}

bool Listener::is_asleep(int i) const {
  const double since = asleep_since_[std::size_t(i)];
  return since > 0 && last_look_ - since > patience_;
}

bool Listener::is_silent(int i) const {
  const Slot& slot = board.slots[i];
  const double heard = std::max({started_, slot.alive.load(), work_[std::size_t(i)].since});
  return i != board.mine && !slot.finished && slot.phase != int(Phase::waiting) &&
         last_look_ - heard > patience_;
}

}  // namespace couplet::app::watching
