// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <concepts>
#include <cstddef>
#include <limits>
#include <span>
#include <type_traits>
#include <utility>
#include <vector>

#include "common/base/error.hpp"

namespace couplet::base {

/// List of values as plain numbers, for checkpoints. The same list of calls writes them and reads them back:
///
///   template <class N>
///   void visit(N& numbers) { numbers(time_, peaks_, name_); }
///
/// Supports numbers, enumerations, strings, pairs, optional values, containers of these, and anything that
/// has such a visit() itself.
class Numbers final {
 public:
  /// Starts writing. values() returns the list afterwards.
  Numbers() = default;
  /// Starts reading. `what` completes "The checkpoint's ... are damaged".
  Numbers(std::span<const double> saved, const char* what) : left_(saved), what_(what) {}

  bool reads() const { return what_ != nullptr; }
  /// Throws Error when reading if too few numbers were saved or the type cannot hold one.
  template <class... T>
  void operator()(T&... values) {
    (one(values), ...);
  }
  /// Reads or writes all values of the span.
  void fill(std::span<double> values) {
    for (double& value : values) real(value);
  }
  const std::vector<double>& values() const { return written_; }
  /// Throws Error unless all saved numbers have been read.
  void finish() const {
    if (!left_.empty()) damaged();
  }
  [[noreturn]] void damaged() const {
    throw Error("The checkpoint's {} are damaged. Use an earlier one.", what_);
  }

 private:
  template <class T>
  void one(T& value) {
    if constexpr (std::is_enum_v<T>) {
      auto number = static_cast<std::underlying_type_t<T>>(value);
      one(number);
      value = static_cast<T>(number);
    } else if constexpr (std::floating_point<T>) {
      real(value);
    } else if constexpr (std::integral<T>) {
      auto number = static_cast<double>(value);
      real(number);
      if (reads() && (number != std::floor(number) || !(number >= least<T>() && number <= largest<T>())))
        damaged();
      value = static_cast<T>(number);
    } else if constexpr (requires { value.has_value(); }) {
      bool is_there = value.has_value();
      one(is_there);
      if (!is_there) value.reset();
      if (is_there && !value) value.emplace();
      if (is_there) one(*value);
    } else if constexpr (requires { value.derived(); }) {  // Eigen types have a visit() of their own
      container(value);
    } else if constexpr (requires { value.visit(*this); }) {
      value.visit(*this);
    } else if constexpr (requires { typename T::mapped_type; }) {
      map(value);
    } else if constexpr (requires { value.first; }) {
      (*this)(value.first, value.second);
    } else {
      container(value);
    }
  }

  /// Largest whole number that both T and a double can hold.
  template <class T>
  static double largest() {
    return std::min(9e15, static_cast<double>(std::numeric_limits<T>::max()));
  }

  template <class T>
  static double least() {
    return std::is_signed_v<T> ? -largest<T>() : 0;
  }

  template <class T>
  void real(T& value) {
    if (!reads()) {
      written_.push_back(static_cast<double>(value));
      return;
    }
    if (left_.empty()) damaged();
    value = static_cast<T>(left_.front());
    left_ = left_.subspan(1);
  }

  std::size_t size(std::size_t n) {
    one(n);
    if (reads() && n > left_.size()) damaged();
    return n;
  }

  template <class T>
  void container(T& values) {
    const std::size_t n = size(static_cast<std::size_t>(values.size()));
    if constexpr (requires { values.resize(n); }) values.resize(n);
    if (n != static_cast<std::size_t>(values.size())) damaged();
    for (auto& value : values) one(value);
  }

  template <class T>
  void map(T& values) {
    std::size_t n = size(values.size());
    if (!reads()) {
      for (auto& [key, value] : values) {
        auto copy = key;
        (*this)(copy, value);
      }
      return;
    }
    values.clear();
    for (; n > 0; --n) {
      std::pair<typename T::key_type, typename T::mapped_type> entry;
      one(entry);
      values.insert(std::move(entry));
    }
  }

  std::vector<double> written_;
  std::span<const double> left_;
  const char* what_ = nullptr;  // nullptr when writing
};

/// Converts a value to plain numbers.
template <class T>
std::vector<double> to_numbers(const T& value) {
  Numbers numbers;
  numbers(const_cast<T&>(value));  // const_cast is safe, since writing changes nothing
  return numbers.values();
}

/// Restores `value` from the result of to_numbers(). Throws Error if that is damaged.
template <class T>
void from_numbers(std::span<const double> saved, T& value, const char* what) {
  Numbers numbers(saved, what);
  numbers(value);
  numbers.finish();
}

}  // namespace couplet::base
