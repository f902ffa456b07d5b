// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace precice {

/// Versions of the interface and of the library that implements it.
std::string getVersionInformation();

}  // namespace precice
