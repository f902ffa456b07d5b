// SPDX-License-Identifier: Apache-2.0
#include "solid_solver/thermal/effect.hpp"

#include "solid_solver/thermal/thermal_strain.hpp"

namespace couplet::solid {

std::vector<std::unique_ptr<SolidEffect>> make_effects(const mesh::Mesh& mesh,
                                                       const elastic::ElasticOperator& elastic,
                                                       const SolidParameters& parameters) {
  std::vector<std::unique_ptr<SolidEffect>> effects;
  if (parameters.heat || parameters.temperature ||
      (parameters.interface_data && parameters.interface_data->temperature))
    effects.push_back(std::make_unique<ThermalStrain>(mesh, elastic, parameters));
  return effects;
}

}  // namespace couplet::solid
