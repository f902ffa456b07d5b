// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <spdlog/sinks/sink.h>

#include <atomic>
#include <chrono>
#include <map>
#include <string>

namespace couplet::log {

/// Where standard output leads to: a file or pipe, a terminal of this process, or the terminal of the mpirun that
/// started it, which the programs of a job share (where mpirun marks or files their lines: none).
enum class Screen { none, own, shared };
Screen screen();

/// For people: at the start at most ten lines of one width, then one line that renews itself with findings above
/// it, at the end what the run found and spent. What it leaves out stands in the log file. At most 100 columns.
/// On a shared terminal the program that makes the steps has the status line; the others print a line at their
/// start and their warnings.
spdlog::sink_ptr terminal_sink(Screen screen, bool is_first_rank);

/// Before the log is set up: whether this program makes the steps of its job.
void set_driver(bool is_driver);

/// The last line, on a terminal alone: where results lie, and which file there has all lines.
void tell_where(const std::string& folder, const std::string& file);

/// "0.4 s", "42 s", "3 min 20 s", "3 h 12 min", "2 d 5 h".
std::string format_duration(double seconds);

/// "ETA 3 h 12 min" if the rest runs as fast as what was done of `total` in `wall_seconds`; empty while
/// nothing was done.
std::string eta(double done, double total, double wall_seconds);

/// Seconds and calls by name; waiting time is a row of its own ("waiting for coupler").
class Timers {
 public:
  struct Entry {
    double seconds = 0;
    long calls = 0;
  };
  void add(const std::string& name, double seconds) {
    Entry& e = entries_[name];
    e.seconds += seconds;
    ++e.calls;
  }
  const std::map<std::string, Entry>& entries() const { return entries_; }
  /// Table with share of `total` seconds, largest first.
  std::string table(const std::string& title, double total) const;

 private:
  std::map<std::string, Entry> entries_;
};

/// Adds the time until the end of the scope.
class ScopedTimer {
 public:
  ScopedTimer(Timers& timers, const char* name) : timers_(timers), name_(name) {}
  ~ScopedTimer() {
    timers_.add(name_, std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count());
  }
  ScopedTimer(const ScopedTimer&) = delete;

 private:
  Timers& timers_;
  const char* name_;
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

/// The timers of this process.
Timers& timers();

/// Where the watch over a job (common/app/watch/watch) hears that this process is alive.
struct LifeSigns {
  std::atomic<double>* last = nullptr;    ///< time of the last sign [s], machine's steady clock
  std::atomic<int>* long_work = nullptr;  ///< above 0: within LongWork
};
void listen_for_life(LifeSigns signs);

/// A sign of life out of work that may take long: an iteration of a solver, a field written. Costs 30 ns.
void alive();

/// Work that can give no sign while it lasts (a factorisation, a mesh being made by another program): until the end of
/// the scope the processor time of the process and of its children is the sign.
class LongWork {
 public:
  LongWork();
  ~LongWork();
  LongWork(const LongWork&) = delete;
  LongWork& operator=(const LongWork&) = delete;
};

}  // namespace couplet::log
