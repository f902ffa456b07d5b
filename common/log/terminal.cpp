// SPDX-License-Identifier: Apache-2.0
#include "common/log/terminal.hpp"

#include <fmt/format.h>
#include <spdlog/sinks/base_sink.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <mutex>
#include <string_view>

namespace couplet::log {
namespace {

constexpr int most_at_start = 9, most_later = 7, most_rows = 4, widest = 100;

std::size_t width() {
  winsize size{};
  const bool known = ioctl(STDOUT_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col >= 20;
  return std::size_t(known ? std::min<int>(size.ws_col, widest) : 80) - 1;
}

/// Bytes of the first `columns` characters of UTF-8.
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
 private:
  void sink_it_(const spdlog::details::log_msg& message) override {
    const std::string_view text(message.payload.data(), message.payload.size());
    if (message.level >= spdlog::level::err) return clear();  // standard error has it
    if (message.level == spdlog::level::warn) return above(fmt::format("warning: {}", text));
    if (text.starts_with("t=")) return renew(text);
    if (!steps_) {
      if (told_++ < most_at_start) print(shortened(text.substr(0, text.find("; neglected: "))));
    } else if (text.find('\n') != text.npos) {
      table(text);
    } else if (text.starts_with("estimated error") || text.find(" dominates: ") != text.npos) {
      above(text);
    } else if (text.starts_with("peak memory") ||
               (!text.starts_with("t = ") && !text.ends_with(": justified") &&
                !text.ends_with(": adequate") && told_++ < most_later)) {
      print(shortened(text));
      fmt::print("{}", shortened(status_));
    }
  }
  void flush_() override { std::fflush(stdout); }

  /// "t=1/2 s  step 10  ..." with the steps a second since the first.
  void renew(std::string_view text) {
    const auto now = std::chrono::steady_clock::now();
    status_ = text;
    if (const std::size_t at = status_.find("ETA "); at != status_.npos) status_.replace(at, 3, "to go");
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
    fmt::print("\r\033[K{}", shortened(status_));
  }
  void clear() {
    if (!status_.empty()) fmt::print("\r\033[K");
    status_.clear();
    std::fflush(stdout);
  }
  void print(std::string_view line) { fmt::print("{}{}\n", status_.empty() ? "" : "\r\033[K", line); }

  /// Broken at blanks; the status stays below.
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
  /// Head, the largest rows and the sum.
  void table(std::string_view text) {
    clear();
    while (text.ends_with('\n')) text.remove_suffix(1);
    for (int row = 0; !text.empty(); ++row) {
      const std::size_t n = std::min(text.find('\n'), text.size());
      const bool is_last = n == text.size();
      if (row <= most_rows || is_last) print(shortened(text.substr(0, n)));
      text.remove_prefix(is_last ? n : n + 1);
    }
  }

  std::string status_;
  int told_ = 0;
  long first_ = 0;  // step, and when it was done
  std::chrono::steady_clock::time_point begun_;
  bool steps_ = false;
};

}  // namespace

bool on_terminal() {
  constexpr std::array launchers{"OMPI_COMM_WORLD_SIZE", "PMIX_RANK", "PMI_RANK", "SLURM_PROCID"};
  return isatty(STDOUT_FILENO) == 1 &&
         std::ranges::none_of(launchers, [](const char* name) { return std::getenv(name) != nullptr; });
}

spdlog::sink_ptr terminal_sink() { return std::make_shared<Terminal>(); }

void tell_where(const std::string& folder, const std::string& file) {
  const auto& sinks = spdlog::default_logger()->sinks();
  if (!sinks.empty() && dynamic_cast<Terminal*>(sinks.front().get()) != nullptr)
    fmt::print("\r\033[Kresults in {}, full log in {}\n", folder, file);
}

}  // namespace couplet::log
