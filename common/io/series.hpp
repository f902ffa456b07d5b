// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <fstream>
#include <limits>
#include <span>
#include <string>
#include <vector>

namespace couplet::io {

/// A CSV time series: first line "time [s],name [unit],...", one line a row, flushed after each. To be made
/// on one rank. `columns` holds all columns, the time first: {"time [s]", "tip x [m]"}; a row has as many
/// values. On restart rows later than restart_time are dropped and the rest is kept.
class Series {
 public:
  Series(const std::filesystem::path& file, const std::vector<std::string>& columns,
         double restart_time = std::numeric_limits<double>::quiet_NaN());
  void row(std::span<const double> values);

 private:
  std::ofstream file_;
  std::size_t n_columns_;
};

}  // namespace couplet::io
