// SPDX-License-Identifier: Apache-2.0
#include "solid_solver/material_parameters.hpp"

namespace couplet {

void declare(config::Section& s, SolidMaterial& m) {
  s.value("density", m.density).unit("kg/m^3").positive().required().doc("density");
  s.value("youngs-modulus", m.youngs_modulus).unit("Pa").positive().required().doc("Young's modulus");
  s.value("poissons-ratio", m.poissons_ratio)
      .range(-0.99, 0.499)
      .required()
      .doc("Poisson's ratio; accuracy fades above 0.45");
}

}  // namespace couplet
