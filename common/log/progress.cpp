// SPDX-License-Identifier: Apache-2.0
#include "common/log/progress.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <spdlog/sinks/base_sink.h>
#include <spdlog/spdlog.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <fstream>
#include <mutex>
#include <string_view>
#include <utility>
#include <vector>

namespace couplet::log {

namespace {

constexpr int most_at_start = 9, most_of_several = 5, widest = 100;

int screen_descriptor = STDOUT_FILENO;  // of the terminal that determines the width
bool drives = false;                    // this program drives the steps of its job

std::string content_of(const std::string& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

/// Process id of the launcher above this process, or 0 if there is none on this machine.
long launcher() {
  constexpr std::array names{"mpirun", "mpiexec", "orterun", "prterun"};
  long process = getppid();
  for (int above = 0; above < 8 && process > 1; ++above) {
    const std::string stat = content_of(fmt::format("/proc/{}/stat", process));  // 17 (mpirun) S 16 ...
    const std::size_t begin = stat.find('('), end = stat.rfind(')');
    if (end == stat.npos || end + 4 >= stat.size()) return 0;
    if (std::ranges::find(names, stat.substr(begin + 1, end - begin - 1)) != names.end()) return process;
    process = std::atol(stat.c_str() + end + 4);
  }
  return 0;
}

/// Returns true if the launcher forwards output unchanged to a terminal of its own.
bool launcher_has_terminal() {
  const long process = launcher();
  if (process == 0) return false;
  const std::string words = content_of(fmt::format("/proc/{}/cmdline", process));
  constexpr std::array marking{"tag-output", "timestamp-output", "output-filename", "-xml"};
  if (std::ranges::any_of(marking, [&](const char* word) { return words.find(word) != words.npos; }))
    return false;
  const int found =
      open(fmt::format("/proc/{}/fd/1", process).c_str(), O_WRONLY | O_NOCTTY | O_NONBLOCK | O_CLOEXEC);
  if (found >= 0 && isatty(found) == 1) {
    screen_descriptor = found;
    return true;
  }
  if (found >= 0) close(found);
  return false;
}

std::size_t width() {
  winsize size{};
  const bool known = ioctl(screen_descriptor, TIOCGWINSZ, &size) == 0 && size.ws_col >= 20;
  return std::size_t(known ? std::min<int>(size.ws_col, widest) : 80) - 1;
}

/// Number of bytes of the first `columns` UTF-8 characters.
std::size_t bytes_of(std::string_view text, std::size_t columns) {
  std::size_t n = 0;
  for (; n < text.size(); ++n)
    if ((static_cast<unsigned char>(text[n]) & 0xC0) != 0x80 && columns-- == 0) break;
  return n;
}

std::string shortened(std::string_view text) {
  const std::size_t n = bytes_of(text, width());
  return n == text.size() ? std::string(text)
                          : fmt::format("{}...", text.substr(0, bytes_of(text, width() - 3)));
}

class Terminal final : public spdlog::sinks::base_sink<std::mutex> {
 public:
  Terminal(bool is_shared, bool is_driver) : is_shared_(is_shared), is_driver_(is_driver) {}
  bool is_driver() const { return is_driver_; }

 private:
  void sink_it_(const spdlog::details::log_msg& message) override {
    const std::string_view text(message.payload.data(), message.payload.size());
    if (message.level >= spdlog::level::err) return clear();  // printed to standard error
    if (message.level == spdlog::level::warn) {
      const std::string_view name(message.logger_name.data(), message.logger_name.size());
      return above(is_shared_ ? fmt::format("[{}] warning: {}", name, text)
                              : fmt::format("warning: {}", text));
    }
    if (text.starts_with("Results of ")) {
      clear();
      return fmt::print("{}\n", text);
    }
    if (!is_driver_) {  // prints one line, since another program has the status line
      if (told_++ == 0) print(shortened(text));
      return;
    }
    if (text.starts_with("t=")) return renew(text);
    if (!steps_ && told_++ < (is_shared_ ? most_of_several : most_at_start))
      print(shortened(text.substr(0, text.find("; off: "))));
  }
  void flush_() override { std::fflush(stdout); }

  /// Renews the status "t=1/2 s  step 10  ..." with the steps per second since the first.
  void renew(std::string_view text) {
    const auto now = std::chrono::steady_clock::now();
    status_ = text;
    const std::string to_go = take_time_to_go();
    const std::size_t at = status_.find("step ");
    long step = 0;
    for (std::size_t i = at == status_.npos ? status_.size() : at + 5;
         i < status_.size() && '0' <= status_[i] && status_[i] <= '9'; ++i)
      step = 10 * step + (status_[i] - '0');
    const double seconds = std::chrono::duration<double>(now - begun_).count();
    if (!steps_) {
      told_ = 0;
      begun_ = now;
      first_ = step;
    } else if (step > first_ && seconds > 0) {
      status_.insert(status_.find("  ", at),
                     fmt::format("  {:.3g} steps/s", double(step - first_) / seconds));
    }
    steps_ = true;
    if (!to_go.empty()) {  // before the costs of parts, since the end may not fit
      const std::size_t rate = status_.find(" steps/s");
      status_.insert(std::min(status_.size(), rate != status_.npos ? rate + 8 : status_.find("  ", at)),
                     "  to go " + to_go);
    }
    fmt::print("\r\033[K{}", shortened(status_));
  }
  /// Removes "  ETA 3 s" from the status and returns the time.
  std::string take_time_to_go() {
    const std::size_t at = status_.find("ETA ");
    if (at == status_.npos) return "";
    const std::size_t end = std::min(status_.find("  ", at), status_.size());
    std::string found = status_.substr(at + 4, end - at - 4);
    const std::size_t begin = status_.find_last_not_of(' ', at == 0 ? 0 : at - 1) + 1;
    status_.erase(begin, end - begin);
    return found;
  }
  void clear() {
    if (!status_.empty() || (is_shared_ && told_ > 0)) fmt::print("\r\033[K");
    status_.clear();
    std::fflush(stdout);
  }
  /// Clears the line, where another program may have left its status.
  void print(std::string_view line) {
    fmt::print("{}{}\n", status_.empty() && !(is_shared_ && told_ > 1) ? "" : "\r\033[K", line);
  }

  /// Prints a text broken at blanks above the status.
  void above(std::string_view text) {
    for (std::string indent; !text.empty(); indent = "  ") {
      std::size_t n = bytes_of(text, width() - indent.size());
      if (const std::size_t blank = text.rfind(' ', n); n < text.size() && blank != text.npos && blank > 0)
        n = blank;
      print(indent + std::string(text.substr(0, n)));
      text.remove_prefix(std::min(text.size(), text.find_first_not_of(' ', n)));
    }
    if (!status_.empty()) fmt::print("{}", shortened(status_));
  }
  std::string status_;
  bool is_shared_, is_driver_;
  int told_ = 0;
  long first_ = 0;  // first step, and when it was completed
  std::chrono::steady_clock::time_point begun_;
  bool steps_ = false;
};

}  // namespace

Screen screen() {
  constexpr std::array launchers{"OMPI_COMM_WORLD_SIZE", "PMIX_RANK", "PMI_RANK", "SLURM_PROCID"};
  if (isatty(STDOUT_FILENO) == 1 &&
      std::ranges::none_of(launchers, [](const char* name) { return std::getenv(name) != nullptr; }))
    return Screen::own;
  static const bool is_shared = launcher_has_terminal();
  return is_shared ? Screen::shared : Screen::none;
}

void set_driver(bool is_driver) { drives = is_driver; }

spdlog::sink_ptr terminal_sink(Screen screen, bool is_first_rank) {
  return std::make_shared<Terminal>(screen == Screen::shared,
                                    screen == Screen::own || (drives && is_first_rank));
}

void log_where(const std::string& folder, const std::string& file) {
  const auto& sinks = spdlog::default_logger()->sinks();
  const auto* terminal = sinks.empty() ? nullptr : dynamic_cast<Terminal*>(sinks.front().get());
  if (terminal != nullptr && terminal->is_driver())
    fmt::print("\r\033[Kresults in {}, full log in {}\n", folder, file);
}

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
  std::vector<std::pair<std::string, Timing>> rows(entries_.begin(), entries_.end());
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
