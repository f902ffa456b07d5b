// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "common/base/types.hpp"

namespace couplet::fv {

/// Values on a full grid of some of x, y, z [m] and t [s] with multilinear interpolation, which is exact for
/// multilinear fields.
class GridTable {
 public:
  enum class Outside {
    clamp,  ///< extrapolates the end values as constants
    error,  ///< throws Error for a value outside
  };
  /// Reads a CSV file. The first line names the columns: axes ("x", "y", "z", "t"; units in brackets must be
  /// m, s and m/s) and `values`. Each further line is a grid point, in any order. Throws Error with file and
  /// line for unknown or missing columns, invalid numbers, and duplicate or missing points. With a `period` above 0 [s], the values
  /// repeat in time, as those of a Table do.
  static GridTable read(const std::filesystem::path& file, const std::vector<std::string>& values,
                        Outside outside, double period = 0);

  /// Interpolates one number per value column. Throws Error with Outside::error.
  void evaluate(const Vec3& x, double t, std::span<double> values) const;
  bool uses_time() const { return !axes_[3].empty(); }

 private:
  static constexpr int n_axes = 4;
  void check_period() const;
  std::string file_;
  Outside outside_ = Outside::clamp;
  double period_ = 0;                             // [s]; 0 if the values do not repeat
  std::array<std::vector<double>, n_axes> axes_;  // of x, y, z, t; empty if absent
  std::vector<double> data_;                      // t fastest, then z, y, x; n_values_ each
  std::size_t n_values_ = 0;
};

}  // namespace couplet::fv
