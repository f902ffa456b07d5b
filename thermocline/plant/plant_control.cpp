// SPDX-License-Identifier: Apache-2.0
#include "thermocline/plant/plant_control.hpp"

#include <algorithm>

namespace couplet::thermocline {

Flow PlantControl::decide(double t, double t_top, double t_bottom, const Ambient& ambient) {
  const PlantFlows flows =
      plant_.flows(plant_.field_heat(ambient.dni), t_top, t_bottom, mode_, plant_.load(t));
  mode_ = flows.mode;
  Flow flow;
  flow.mode = static_cast<int>(mode_);
  flow.mass_flow = flows.tank_flow;
  flow.inlet_temperature = mode_ == PlantMode::charge ? plant_.parameters().hot : plant_.parameters().cold;
  // At rest the bed could take long steps over sunrise.
  constexpr double longest_without_a_look = 120;  // [s]
  flow.until = std::min(t + longest_without_a_look, plant_.load_until(t));
  return flow;
}

}  // namespace couplet::thermocline
