// SPDX-License-Identifier: Apache-2.0
#include "common/log/log.hpp"

#include <spdlog/pattern_formatter.h>
#include <spdlog/sinks/base_sink.h>
#include <spdlog/sinks/stdout_sinks.h>

#include <fstream>
#include <memory>
#include <mutex>
#include <utility>
#include <vector>

#include "common/base/error.hpp"
#include "common/base/own_file.hpp"
#include "common/log/progress.hpp"

namespace couplet::log {
namespace {

/// Writes to standard output, except errors, which only go to standard error.
class BelowError final : public spdlog::sinks::stdout_sink_mt {
 public:
  void log(const spdlog::details::log_msg& message) override {
    if (message.level < spdlog::level::err) spdlog::sinks::stdout_sink_mt::log(message);
  }
};

/// Appends to a file, from when files are no longer held (see base::hold_files).
class LogFile final : public spdlog::sinks::base_sink<std::mutex> {
 public:
  explicit LogFile(std::string name) : name_(std::move(name)) {}
  void open() {
    const std::lock_guard<std::mutex> lock(mutex_);
    file_.open(name_, std::ios::app);
    if (!(file_ << text_ << std::flush))
      throw Error("The log file '{}' cannot be written. Check the output folder and its permissions.", name_);
    text_.clear();
  }

 private:
  void sink_it_(const spdlog::details::log_msg& message) override {
    spdlog::memory_buf_t text;
    formatter_->format(message, text);
    if (file_.is_open())
      file_.write(text.data(), std::streamsize(text.size()));
    else
      text_.append(text.data(), text.size());
  }
  void flush_() override { file_.flush(); }

  std::string name_, text_;
  std::ofstream file_;
};

/// Adds "warning: " or "error: " before the message.
class Label final : public spdlog::custom_flag_formatter {
 public:
  void format(const spdlog::details::log_msg& message, const std::tm&, spdlog::memory_buf_t& out) override {
    std::string_view text;
    if (message.level == spdlog::level::warn) text = "warning: ";
    if (message.level >= spdlog::level::err) text = "error: ";
    out.append(text.data(), text.data() + text.size());
  }
  std::unique_ptr<spdlog::custom_flag_formatter> clone() const override { return std::make_unique<Label>(); }
};

std::string pattern(const std::string& participant, int rank) {
  std::string name;
  for (const char c : participant) name += c == '%' ? std::string("%%") : std::string(1, c);
  return fmt::format("[{} {}] %*%v", name, rank);
}

}  // namespace

void setup(const std::string& participant, int rank, Verbosity verbosity, const std::string& file) {
  std::vector<spdlog::sink_ptr> sinks;
  if (verbosity == Verbosity::normal && screen() != Screen::none)
    sinks.push_back(terminal_sink(screen(), rank == 0));
  else
    sinks.push_back(std::make_shared<BelowError>());
  sinks.push_back(std::make_shared<spdlog::sinks::stderr_sink_mt>());
  sinks.back()->set_level(spdlog::level::err);
  if (!file.empty() && rank == 0) {
    const auto log_file = std::make_shared<LogFile>(base::own_file(file).string());
    sinks.push_back(log_file);
    base::when_started([log_file] { log_file->open(); });
  }
  const auto logger = std::make_shared<spdlog::logger>(participant, sinks.begin(), sinks.end());
  auto formatter = std::make_unique<spdlog::pattern_formatter>();
  formatter->add_flag<Label>('*').set_pattern(pattern(participant, rank));
  logger->set_formatter(std::move(formatter));
  if (verbosity == Verbosity::verbose)
    logger->set_level(spdlog::level::debug);
  else
    logger->set_level(rank > 0                         ? spdlog::level::err
                      : verbosity == Verbosity::normal ? spdlog::level::info
                                                       : spdlog::level::warn);
  // Standard output is a pipe under mpirun. One flush per step is acceptable.
  logger->flush_on(spdlog::level::info);
  spdlog::set_default_logger(logger);
}

}  // namespace couplet::log
