// SPDX-License-Identifier: Apache-2.0
#pragma once

/// Page of shared memory by which processes of a job on one machine watch each other (see supervisor.hpp).

#include <unistd.h>

#include <atomic>
#include <string_view>
#include <vector>

#include "common/app/supervision/supervisor.hpp"

namespace couplet::app::watching {

struct Slot {
  char participant[64];
  std::atomic<int> pid, rank, phase, guest, ending, finished, terminating, reported, spoke_for_all;
  std::atomic<int> stop_requested, stopped;  // of the job: in the first slot
  std::atomic<double> time;
  std::atomic<double> alive;        // last sign of life [s] on the machine's steady clock
  std::atomic<int> long_work;       // above 0: processor time is the sign (log::LongWork)
  std::atomic<double> waits_since;  // start of a long wait, or 0
  std::atomic<double> looked;       // last time the wait polled for its message
  char waits_for[128];              // written before waits_since
};
static_assert(std::atomic<int>::is_always_lock_free && std::atomic<double>::is_always_lock_free);

// Signal handlers can only use static storage. Written once, before the handler is installed.
struct Board {
  Slot* slots = nullptr;  // one a process of this machine, by world rank; behind them those of guests
  int count = 0;
  int mine = 0;
  bool whole_job = false;  // all of the project's processes of the job are on this machine
  bool has_guests = false;
};
extern Board board;

/// Text for the signal handler, built without allocation.
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
  /// Appends a number with six decimals, or none for whole numbers.
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

/// Time of the machine's steady clock [s].
double now();
/// State of the process in /proc: R running, S sleeping, T stopped, Z zombie, X if it does not exist.
char state_of(int pid);
/// Returns true if the process does not exist or is a zombie.
bool gone(int pid);
/// Processor time of the process and its children [s], or 0 if unknown. Not for signal handlers.
double processor_seconds_of(int pid);
/// Appends "participant 'solid' (rank 0, pid 7) <fate>; last heard of in solve at t = 0.1 s".
void describe(Line& line, const Slot& slot, std::string_view fate);
/// Ends this process and thus the job. Only the first caller writes the line.
[[noreturn]] void end_job_with(const Line& line);

/// Reports long waits of this process to the others, each as a sign of life, and checks if all processes
/// wait. Then nobody can send the awaited messages, so the job is ended with their names, regardless of the
/// hang timeout. Disabled if there are guests or other machines, which may still be working.
void watch_waits();

/// Tracks the silence of the other processes as seen by this one.
class Listener {
 public:
  explicit Listener(double patience);
  /// Time between two checks [s]: 1/120 of the patience, at most 5 s.
  double period() const { return period_; }

  /// Ends the job if a process is silent: stopped, or without a sign of life although it is not waiting. The
  /// coupler is named only if no other process can be.
  void check();

 private:
  /// Processor time of a process during long work, and the time of its last increase.
  struct WorkTime {
    double seconds = 0, since = 0;  // since = 0 means no long work
  };
  void hear(int i);
  bool is_asleep(int i) const;
  bool is_silent(int i) const;
  void speak(bool any_asleep, bool any_busy) const;

  double patience_, period_, last_look_, started_;
  std::vector<double> asleep_since_;  // 0 means awake
  std::vector<WorkTime> work_;
};

}  // namespace couplet::app::watching
