// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace precice {

/// Versions of the interface and of the library behind it.
std::string getVersionInformation();

}  // namespace precice
