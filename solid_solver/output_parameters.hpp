// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/base/types.hpp"
#include "common/config/section.hpp"

namespace couplet {

struct SolidProbe {
  Vec3 point = Vec3::Zero();
};

/// Fields written at the output interval.
struct SolidOutputParameters {
  bool deformed = true;
  bool stress = true;
};

void declare(config::Section& section, SolidProbe& probe);
void declare(config::Section& section, SolidOutputParameters& output);

}  // namespace couplet
