// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/config/section.hpp"

namespace couplet {

struct SolidMaterial {
  double density = 0;         // [kg/m^3]
  double youngs_modulus = 0;  // [Pa]
  double poissons_ratio = 0;
};

void declare(config::Section& section, SolidMaterial& material);

}  // namespace couplet
