// SPDX-License-Identifier: Apache-2.0
#pragma once

/// The page of shared memory by which the processes of a job on one machine watch over each other (see watch.hpp).

#include <unistd.h>

#include <atomic>
#include <string_view>
#include <vector>

#include "common/app/watch/watch.hpp"

namespace couplet::app::watching {

struct Slot {
  char participant[64];
  std::atomic<int> pid, rank, phase, guest, ending, finished, terminating, reported, spoke_for_all;
  std::atomic<int> stop_requested, stopped;  // of the job: in the first slot
  std::atomic<double> time;
  std::atomic<double> alive;        // last sign of life [s] on the machine's steady clock
  std::atomic<int> long_work;       // above 0: processor time is the sign (log::LongWork)
  std::atomic<double> waits_since;  // of a wait that lasts; 0: none
  std::atomic<double> looked;       // when the wait has last looked for its message
  char waits_for[128];              // written before waits_since
};
static_assert(std::atomic<int>::is_always_lock_free && std::atomic<double>::is_always_lock_free);

// A signal handler can only reach what has static storage. Written once, before the handler is installed.
struct Board {
  Slot* slots = nullptr;  // one a process of this machine, by world rank; behind them those of guests
  int count = 0;
  int mine = 0;
  bool whole_job = false;  // all of the project's processes of the job are on this machine
  bool has_guests = false;
};
extern Board board;

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

/// Of the machine's steady clock [s].
double now();
/// The letter of the process in /proc: R running, S sleeping, T stopped, Z waiting to be buried; X: there is none.
char state_of(int pid);
/// No such process, or one that only waits to be buried.
bool gone(int pid);
/// Processor time of the process and of its children [s]; 0: unknown. Not for signal handlers.
double processor_seconds_of(int pid);
/// "participant 'solid' (rank 0, pid 7) <fate>; last heard of in solve at t = 0.1 s"
void describe(Line& line, const Slot& slot, std::string_view fate);
/// The first to come writes the line for all and ends its process, and by that the job.
[[noreturn]] void end_job_with(const Line& line);

/// From now on this process tells the others of waits that last, each a sign of life, and looks whether all of them
/// wait: nobody is left then to send what any of them waits for, and the job ends with the names, whatever the hang
/// timeout. Only where all processes of the job can be seen: a guest, or another machine, may be the one that works.
void watch_waits();

/// Records what one process notices of the others' silence, look by look.
class Listener {
 public:
  explicit Listener(double patience);
  /// Between two looks [s]: a 120th of the patience, 5 s at most.
  double period() const { return period_; }

  /// Ends the job if a process is silent: it is stopped, or nothing has been heard of it although it is not one that
  /// waits. The coupler is named only if nobody else can be.
  void look();

 private:
  /// Processor time of a process in work that gives no sign, and when it last went on.
  struct Work {
    double seconds = 0, since = 0;  // since 0: it does no such work
  };
  void hear(int i);
  bool is_asleep(int i) const;
  bool is_silent(int i) const;
  void speak(bool any_asleep, bool any_busy) const;

  double patience_, period_, last_look_, started_;
  std::vector<double> asleep_since_;  // 0: awake
  std::vector<Work> work_;
};

}  // namespace couplet::app::watching
