// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdexcept>

namespace precice {

/// Invalid call or configuration, or an unsupported feature. The text names it.
class Error : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

}  // namespace precice
