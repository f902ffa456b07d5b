// SPDX-License-Identifier: Apache-2.0
#include "common/io/series.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <optional>

#include "common/base/error.hpp"
#include "common/base/own_file.hpp"

namespace couplet {
namespace {

// The time of a complete row: a number, and as many columns as the head has. A row cut by a crash has none.
std::optional<double> time_of(const std::string& line, std::size_t n_columns) {
  if (std::size_t(std::count(line.begin(), line.end(), ',')) + 1 != n_columns) return std::nullopt;
  double time = 0;
  const auto [end, code] = std::from_chars(line.data(), line.data() + line.size(), time);
  if (code != std::errc() || (end != line.data() + line.size() && *end != ',')) return std::nullopt;
  return time;
}

// The old text up to restart_time.
std::string kept_rows(const std::filesystem::path& file, const std::string& head, std::size_t n_columns,
                      double restart_time) {
  std::ifstream old(file);
  std::string line, kept;
  if (!old || !std::getline(old, line)) return head + "\n";
  if (line != head)
    throw Error(
        "The series '{}' cannot be continued: its columns are '{}', those of this run '{}'. Move it away.",
        file.string(), line, head);
  kept = line + "\n";
  // Accepted times are sums of steps: equal to round-off only.
  const double last = restart_time + 1e-9 * std::abs(restart_time);
  while (std::getline(old, line)) {
    const auto time = time_of(line, n_columns);
    const bool complete = !old.eof();
    if (time && complete && *time <= last) kept += line + "\n";
  }
  return kept;
}

}  // namespace

Series::Series(const std::filesystem::path& file, const std::vector<std::string>& columns,
               double restart_time)
    : n_columns_(columns.size()) {
  const std::string head = fmt::format("{}", fmt::join(columns, ","));
  std::error_code code;
  if (file.has_parent_path()) std::filesystem::create_directories(file.parent_path(), code);
  const std::string text =
      std::isnan(restart_time) ? head + "\n" : kept_rows(file, head, n_columns_, restart_time);
  const std::filesystem::path part = file.string() + ".part";
  own_file(file);
  std::ofstream(own_file(part)) << text;
  std::filesystem::rename(part, file, code);
  if (!code) file_.open(file, std::ios::app);
  if (code || !file_)
    throw Error("The series '{}' cannot be written. Is the folder there and may you write to it?",
                file.string());
}

void Series::row(std::span<const double> values) {
  if (values.size() != n_columns_)
    throw Error("A series row has {} values, its head {} columns.", values.size(), n_columns_);
  // The shortest text that reads back as the same number.
  file_ << fmt::format("{}\n", fmt::join(values, ","));
  file_.flush();
  if (!file_) throw Error("A series row could not be written. Is the disk full?");
}

}  // namespace couplet
