// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/config/section.hpp"
#include "solid_solver/heat_parameters.hpp"

namespace couplet {

struct SolidMaterial {
  double density = 0;         // [kg/m^3]
  double youngs_modulus = 0;  // [Pa]
  double poissons_ratio = 0;
  HeatMaterial heat{};
};

/// `is_elastic`: the elastic constants are needed.
void declare(config::Section& section, SolidMaterial& material, bool is_elastic = true);

}  // namespace couplet
