// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <limits>
#include <string>

#include "common/io/fields/mesh_part.hpp"

namespace couplet::solid {

/// Where a solid stands among the other programs.
struct SolidContext {
  std::string name = "solid";
  std::filesystem::path output_folder;  ///< empty: nothing is written
  double restart_time = std::numeric_limits<double>::quiet_NaN();
  io::FieldChoice fields{};
};

}  // namespace couplet::solid
