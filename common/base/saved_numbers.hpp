// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>

#include "common/base/error.hpp"

namespace couplet::base {

/// Numbers out of a checkpoint that say themselves how many follow: taken one after the other, and none that is not there.
/// Throws Error.
class SavedNumbers final {
 public:
  /// `what` completes "The checkpoint's ... are damaged".
  SavedNumbers(std::span<const double> values, const char* what) : left_(values), what_(what) {}
  std::span<const double> next(std::size_t n) {
    if (n > left_.size()) damaged();
    const std::span<const double> taken = left_.first(n);
    left_ = left_.subspan(n);
    return taken;
  }
  std::size_t left() const { return left_.size(); }
  double real() { return next(1)[0]; }
  /// A whole number from 0 to `most`.
  std::size_t count(double most) {
    const double value = real();
    if (!(value >= 0 && value <= most) || value != std::floor(value)) damaged();
    return static_cast<std::size_t>(value);
  }
  /// Of entries that take `size` numbers each, all of which must follow.
  std::size_t count_of(std::size_t size) {
    const std::size_t n = count(double(left_.size()));
    if (n > left_.size() / size) damaged();
    return n;
  }
  void fill(std::span<double> to) { std::ranges::copy(next(to.size()), to.begin()); }
  std::span<const double> rest() { return next(left_.size()); }
  [[noreturn]] void damaged() const {
    throw Error("The checkpoint's {} are damaged. Use an earlier one.", what_);
  }

 private:
  std::span<const double> left_;
  const char* what_;
};

}  // namespace couplet::base
