// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>

namespace couplet::io {

struct OutputField {
  enum class Place { cells, points };
  std::string name;  ///< "velocity"
  std::string unit;  ///< "m/s"; shown in ParaView as "velocity [m/s]"
  Place place = Place::cells;
  int components = 1;              ///< 1, 2 or 3; 2 is padded to 3 in the file
  std::span<const double> values;  ///< per local cell or point (ghosts are ignored), entry by entry
};

}  // namespace couplet::io
