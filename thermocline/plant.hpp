// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/config/section.hpp"

namespace couplet::thermocline {

/// Solar field, power block and the limits within which the store may work [thesis, section 5.2.1].
struct PlantParameters {
  double electric_power = 0;      ///< W_EG, day and night [W]
  double block_efficiency = 0.4;  ///< eta_PB
  double field_area = 0;          ///< S_SF [m^2]
  double field_efficiency = 0.6;  ///< eta_SF
  double hot = 0, cold = 0;       ///< design temperatures [K]
  double cut_off = 15;            ///< dT_CO [K]
  double restart = 10;            ///< dT_R [K]
};
void declare(config::Section& section, PlantParameters& parameters);

enum class PlantMode { standby, charge, discharge };

/// What flows in the plant during one step.
struct PlantFlows {
  PlantMode mode = PlantMode::standby;
  double field_heat = 0;   ///< Q_SF: what the sun offers, mean over the step [W]
  double block_heat = 0;   ///< Q_PB: what the power block asks for [W]
  double field_flow = 0;   ///< m_SF [kg/s]
  double block_flow = 0;   ///< m_PB [kg/s]
  double field_inlet = 0;  ///< T_SF^in, mixed [K]
  double block_inlet = 0;  ///< T_PB^in, mixed [K]
  double tank_flow = 0;    ///< upward: > 0 discharge, < 0 charge [kg/s]
  bool has_excess() const { return field_heat > block_heat; }
};

/// Plant management, equations 5.1 to 5.6. The fluid's specific heat is constant, so the mixing rules 5.5
/// and 5.6 and the balances 5.3 and 5.4, each implicit in flow and temperature, have the closed solution
///   m_C = (Q_SF - Q_PB) / (c (T_hot - T_C)),   m_D = (Q_PB - Q_SF) / (c (T_D - T_cold)).
class Plant {
 public:
  /// `specific_heat` of the fluid [J/(kg K)].
  Plant(const PlantParameters& parameters, double specific_heat);

  /// Flows of a step that starts with the outlet temperatures `top` and `bottom` of the tank [K]. `before`
  /// is the mode of the step before: a process that runs goes on until the mixed temperature reaches its
  /// cut-off, one that does not run starts only within the restart tolerance.
  PlantFlows flows(double field_heat, double top, double bottom, PlantMode before) const;

  double field_heat(double irradiance) const;  ///< equation 5.2 [W]
  double block_heat() const;                   ///< equation 5.1 [W]
  const PlantParameters& parameters() const { return p_; }
  double specific_heat() const { return c_; }

 private:
  PlantFlows idle(double field_heat) const;
  PlantFlows charge(double field_heat, double bottom) const;
  PlantFlows discharge(double field_heat, double top) const;

  PlantParameters p_;
  double c_;
};

}  // namespace couplet::thermocline
