// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fmt/format.h>

#include <stdexcept>
#include <string>

namespace couplet {

/// Something the user can mend: what is wrong, where, what was expected, what to do. Full sentences.
class Error : public std::runtime_error {
 public:
  explicit Error(const std::string& text) : std::runtime_error(text) {}
  template <class... Args>
  requires(sizeof...(Args) > 0) explicit Error(fmt::format_string<Args...> text, Args&&... args)
      : std::runtime_error(fmt::format(text, std::forward<Args>(args)...)) {}
};

/// A step that could not be solved (linear solver, inverted cell, NaN). A coupler may try a smaller step.
class SolveFailure : public Error {
 public:
  using Error::Error;
};

/// A step that the scheme cannot solve whatever its length: nothing is gained by a smaller one.
class SchemeFailure final : public SolveFailure {
 public:
  using SolveFailure::SolveFailure;
};

}  // namespace couplet
