// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <map>
#include <string>

namespace couplet::log {

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

}  // namespace couplet::log
