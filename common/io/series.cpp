// SPDX-License-Identifier: Apache-2.0
#include "common/io/series.hpp"

#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <memory>
#include <optional>
#include <sstream>

#include "common/base/error.hpp"
#include "common/base/own_file.hpp"
#include "common/csv/csv_reader.hpp"
#include "common/diagnostics/results.hpp"
#include "common/io/checkpoint_set.hpp"
#include "common/log/log.hpp"

namespace couplet::io {
namespace {

// The length of a series is unlimited, since it grows with the run. A crash may leave zeros in its last row.
constexpr csv::Limits of_series{.bytes = std::numeric_limits<std::uint64_t>::max(),
                                .line = std::size_t(1) << 20,
                                .lines = std::numeric_limits<std::size_t>::max(),
                                .text_only = false};

// Time of a complete row, whose number of columns matches the header. A truncated row has none.
std::optional<double> time_of(std::string_view line, std::size_t n_columns,
                              std::vector<std::string_view>& cells) {
  csv::split_cells(line, ',', cells);
  return cells.size() == n_columns ? csv::number_of(cells[0]) : std::nullopt;
}

// Opens the rows of an existing file behind its header. nullptr if there are none.
std::unique_ptr<csv::LineReader> rows_of(const std::filesystem::path& file, const std::string& head) {
  std::error_code ignored;
  if (!std::filesystem::exists(file, ignored)) return nullptr;
  auto old = std::make_unique<csv::LineReader>(file, "series", of_series);
  std::string_view line;
  if (!old->next(line)) return nullptr;
  if (line != head)
    throw Error(
        "Cannot continue the series '{}': its columns are '{}', but those of this run are '{}'. Move the file away.",
        file.string(), line, head);
  return old;
}

void copy_rows(csv::LineReader& old, std::size_t n_columns, double restart_time, std::ostream& out) {
  // Accepted times are sums of steps and therefore equal only to round-off.
  const double last = restart_time + 1e-9 * std::abs(restart_time);
  std::vector<std::string_view> cells;
  for (std::string_view line; old.next(line);) {
    const auto time = time_of(line, n_columns, cells);
    if (time && old.has_end() && *time <= last) out << line << '\n';
  }
}

}  // namespace

Series::Series(const std::filesystem::path& file, const std::vector<std::string>& columns,
               double restart_time)
    : name_(file),
      last_(diagnostics::results_of_table(file.stem().string(), columns)),
      n_columns_(columns.size()) {
  for (const std::string& name : columns)
    if (name.find_first_of(",\"") != std::string::npos)
      throw Error(
          "Cannot write the series '{}': '{}' would be the name of a column, which must not contain a comma or a double quote. Rename it.",
          file.string(), name);
  const std::string head = fmt::format("{}", fmt::join(columns, ","));
  std::error_code code;
  if (file.has_parent_path()) std::filesystem::create_directories(file.parent_path(), code);
  std::ostringstream text;
  text << head << '\n';
  if (!std::isnan(restart_time)) {
    warn_if_lost(file, restart_time);
    if (const auto old = rows_of(file, head)) copy_rows(*old, n_columns_, restart_time, text);
  }
  base::write_file(file, text.view());
}

Series::~Series() {
  std::error_code ignored;
  if (file_.is_open() && !std::filesystem::exists(name_, ignored))
    log::warn("'{}' was removed during the run: its rows are lost.", name_.string());
}

void Series::row(std::span<const double> values) {
  if (values.size() != n_columns_)
    throw Error("A series row has {} values, but its header has {} columns.", values.size(), n_columns_);
  if (last_) last_->assign(values.begin(), values.end());
  if (!file_.is_open()) file_.open(name_, std::ios::app);
  // The default format is the shortest text that restores the same number.
  file_ << fmt::format("{}\n", fmt::join(values, ","));
  file_.flush();
  if (!file_) throw Error("Cannot write a row of '{}'. Is the disk full?", name_.string());
}

}  // namespace couplet::io
