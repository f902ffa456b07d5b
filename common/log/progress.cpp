// SPDX-License-Identifier: Apache-2.0
#include "common/log/progress.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <ctime>
#include <utility>
#include <vector>

namespace couplet::log {

std::string format_duration(double seconds) {
  if (seconds < 9.95) return fmt::format("{:.1f} s", std::max(seconds, 0.0));
  const long s = std::lround(seconds);
  if (s < 60) return fmt::format("{} s", s);
  if (s < 3600) return fmt::format("{} min {} s", s / 60, s % 60);
  const long minutes = std::lround(seconds / 60);
  if (minutes < 24 * 60) return fmt::format("{} h {} min", minutes / 60, minutes % 60);
  const long hours = std::lround(seconds / 3600);
  return fmt::format("{} d {} h", hours / 24, hours % 24);
}

std::string eta(double done, double total, double wall_seconds) {
  if (done <= 0) return "";
  return fmt::format("ETA {}", format_duration(wall_seconds * std::max(total - done, 0.0) / done));
}

std::string Timers::table(const std::string& title, double total) const {
  std::vector<std::pair<std::string, Entry>> rows(entries_.begin(), entries_.end());
  std::stable_sort(rows.begin(), rows.end(),
                   [](const auto& a, const auto& b) { return a.second.seconds > b.second.seconds; });
  std::size_t width = title.size();
  for (const auto& [name, entry] : rows) width = std::max(width, name.size());
  const auto share = [total](double seconds) { return total > 0 ? 100 * seconds / total : 0.0; };
  std::string out = fmt::format("{:<{}}  {:>10}  {:>7}  {:>9}\n", title, width, "seconds", "share", "calls");
  for (const auto& [name, entry] : rows)
    out += fmt::format("{:<{}}  {:>10.3f}  {:>5.1f} %  {:>9}\n", name, width, entry.seconds,
                       share(entry.seconds), entry.calls);
  out += fmt::format("{:<{}}  {:>10.3f}  {:>5.1f} %\n", "total", width, total, share(total));
  return out;
}

Timers& timers() {
  static Timers all;
  return all;
}

namespace {

LifeSigns& listener() {
  static LifeSigns signs;
  return signs;
}

}  // namespace

void listen_for_life(LifeSigns signs) { listener() = signs; }

void alive() {
  if (listener().last == nullptr) return;
  timespec t{};
  ::clock_gettime(CLOCK_MONOTONIC, &t);
  *listener().last = double(t.tv_sec) + 1e-9 * double(t.tv_nsec);
}

LongWork::LongWork() {
  alive();
  if (listener().long_work) ++*listener().long_work;
}

LongWork::~LongWork() {
  if (listener().long_work) --*listener().long_work;
  alive();
}

}  // namespace couplet::log
