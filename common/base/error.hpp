// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fmt/format.h>

#include <stdexcept>
#include <string>

namespace couplet {

/// Error that the user can fix. Full sentences say what is wrong, where, what was expected and what to do.
class Error : public std::runtime_error {
 public:
  explicit Error(const std::string& text) : std::runtime_error(text) {}
  template <class... Args>
  requires(sizeof...(Args) > 0) explicit Error(fmt::format_string<Args...> text, Args&&... args)
      : std::runtime_error(fmt::format(text, std::forward<Args>(args)...)) {}
};

/// Step that could not be solved (linear solver, inverted cell, NaN). The coupler may try a smaller step.
class SolveFailure : public Error {
 public:
  using Error::Error;
};

/// Step that the scheme cannot solve whatever its length, so that a smaller one does not help.
class SchemeFailure final : public SolveFailure {
 public:
  using SolveFailure::SolveFailure;
};

}  // namespace couplet
