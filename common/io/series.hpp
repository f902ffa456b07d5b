// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <fstream>
#include <limits>
#include <span>
#include <string>
#include <vector>

namespace couplet::io {

/// CSV time series: first line "time [s],name [unit],...", then one line per row, flushed after each. Create
/// it on one rank; the file is opened for the first row. `columns` includes the time: {"time [s]", "tip x [m]"}. A row has as many values. On
/// restart rows later than `restart_time` are dropped.
class Series {
 public:
  Series(const std::filesystem::path& file, const std::vector<std::string>& columns,
         double restart_time = std::numeric_limits<double>::quiet_NaN());
  /// Warns if the file is no longer there.
  ~Series();
  Series(Series&&) = default;
  void row(std::span<const double> values);

 private:
  std::filesystem::path name_;
  std::vector<double>* last_;  // row at the end, if the results of the run show it
  std::ofstream file_;
  std::size_t n_columns_;
};

}  // namespace couplet::io
