// SPDX-License-Identifier: Apache-2.0
#include "solid_solver/material_parameters.hpp"

namespace couplet {

void declare(config::Section& s, SolidMaterial& m, bool is_elastic) {
  s.value("density", m.density).unit("kg/m^3").positive().required().doc("density");
  const auto needed = [is_elastic](config::Key& key) -> config::Key& {
    return is_elastic ? key.required() : key;
  };
  needed(s.value("youngs-modulus", m.youngs_modulus).unit("Pa").positive().doc("Young's modulus"));
  needed(s.value("poissons-ratio", m.poissons_ratio)
             .range(-0.99, 0.49999)
             .doc("Poisson's ratio; from 0.4 up the symmetric face gradient is the default"));
  s.value("yield-strength", m.yield_strength)
      .unit("Pa")
      .positive()
      .doc("the run says where the equivalent stress reaches it; changes nothing else");
  declare(s, m.heat);
}

void declare(config::Section& s, ZoneMaterial& m, bool is_elastic) {
  s.value("zones", m.zones)
      .doc("physical volumes (2-D: surfaces) of the mesh that are made of it; without: the one of this name");
  declare(s, static_cast<SolidMaterial&>(m), is_elastic);
}

std::vector<std::vector<std::string>> zones_of(const ZoneMaterials& materials) {
  std::vector<std::vector<std::string>> zones;
  for (const auto& [name, material] : materials)
    zones.push_back(material.zones.empty() ? std::vector<std::string>{name} : material.zones);
  return zones;
}

}  // namespace couplet
