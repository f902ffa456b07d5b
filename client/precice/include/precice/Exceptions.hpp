// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdexcept>

namespace precice {

/// A wrong call, a configuration that cannot be run, or what this library does not support: the text names it.
class Error : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

}  // namespace precice
