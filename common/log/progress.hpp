// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <spdlog/sinks/sink.h>

#include <atomic>
#include <chrono>
#include <map>
#include <string>

namespace couplet::log {

/// Destination of standard output: a file or pipe (none), a terminal of this process (own), or the terminal
/// of the mpirun that started it, shared by the job. It is none if mpirun tags or redirects lines.
enum class Screen { none, own, shared };
Screen screen();

/// Sink for terminals. It prints at most ten lines at the start, then a status line with findings above it,
/// and finally the results. The log file holds the rest. Lines have at most 100 columns. On a shared
/// terminal only the program that drives the steps has the status line. The others print one line at their
/// start and their warnings.
spdlog::sink_ptr terminal_sink(Screen screen, bool is_first_rank);

/// Sets if this program drives the steps of its job. Call it before the log is set up.
void set_driver(bool is_driver);

/// Prints the last line, only on a terminal: the location of the results and the file with all lines.
void log_where(const std::string& folder, const std::string& file);

/// Formats "0.4 s", "42 s", "3 min 20 s", "3 h 12 min", "2 d 5 h".
std::string format_duration(double seconds);

/// Text "ETA 3 h 12 min", extrapolated from `done` of `total` in `wall_seconds`. Empty while `done` is 0.
std::string eta(double done, double total, double wall_seconds);

/// Accumulated seconds and calls by name. Waiting time has a row of its own ("waiting for coupler").
class Timers {
 public:
  struct Timing {
    double seconds = 0;
    long calls = 0;
  };
  void add(const std::string& name, double seconds) {
    Timing& e = entries_[name];
    e.seconds += seconds;
    ++e.calls;
  }
  const std::map<std::string, Timing>& entries() const { return entries_; }
  /// Table with shares of `total` seconds, largest first.
  std::string table(const std::string& title, double total) const;

 private:
  std::map<std::string, Timing> entries_;
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

/// Timers of this process.
Timers& timers();

/// Signs of life of this process for the watch over a job (common/app/supervision/supervisor).
struct LifeSigns {
  std::atomic<double>* last = nullptr;    ///< time of the last sign [s], steady clock of the machine
  std::atomic<int>* long_work = nullptr;  ///< above 0 within LongWork
};
void listen_for_life(LifeSigns signs);

/// Gives a sign of life within long work: an iteration of a solver, a field written. Takes 30 ns.
void alive();

/// Work that cannot give signs of life (a factorization, another program that makes a mesh). Until the end of
/// the scope, processor time of the process and its children counts as a sign.
class LongWork {
 public:
  LongWork();
  ~LongWork();
  LongWork(const LongWork&) = delete;
  LongWork& operator=(const LongWork&) = delete;
};

}  // namespace couplet::log
