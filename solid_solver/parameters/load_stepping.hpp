// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/config/section.hpp"

namespace couplet::solid {

struct SolidParameters;

/// How a static run at large strain goes from one equilibrium to the next.
struct LoadStepping {
  enum class Type { load, arc_length };
  Type type = Type::load;
  double first_load_factor = 0.05;  // of the first step
  int iterations = 5;               // that a step should take
  double longest = 10;              // step over the first one
};

void declare(config::Section& section, LoadStepping& stepping);
/// What the arc length cannot have, each told at the key to change.
void check_load_stepping(config::Section& section, SolidParameters& parameters);

}  // namespace couplet::solid
