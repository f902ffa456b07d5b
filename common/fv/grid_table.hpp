// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "common/base/types.hpp"

namespace couplet::fv {

/// Values given on a full grid of some of x, y, z [m] and t [s]; linear along each axis in between
/// (multilinear), so exact for fields that are.
class GridTable {
 public:
  enum class Outside {
    clamp,  ///< the ends hold beyond the ends
    error,  ///< a value outside is an Error
  };
  /// A CSV file: the first line names its columns, axes ("x", "y", "z", "t"; units in brackets must be m, s and
  /// m/s) and `values`; one line a place of the grid, in any order. Throws Error naming file and line: unknown or
  /// missing columns, what is no number, places twice or missing.
  static GridTable read(const std::filesystem::path& file, const std::vector<std::string>& values,
                        Outside outside);

  /// One number a value column. Throws Error with Outside::error.
  void evaluate(const Vec3& x, double t, std::span<double> values) const;
  bool uses_time() const { return !axes_[3].empty(); }

 private:
  static constexpr int n_axes = 4;
  std::string file_;
  Outside outside_ = Outside::clamp;
  std::array<std::vector<double>, n_axes> axes_;  // of x, y, z, t; empty: none
  std::vector<double> data_;                      // t fastest, then z, y, x; n_values_ each
  std::size_t n_values_ = 0;
};

}  // namespace couplet::fv
