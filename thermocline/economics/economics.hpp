// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "common/config/section.hpp"

namespace couplet::thermocline {

/// Prices, in a currency of one's own.
struct EconomicsParameters {
  double field = 0;                         ///< of a square metre of solar field [1/m^2]
  double block = 0;                         ///< of a kilowatt of the power block's electric output [1/kW]
  double fixed = 0;                         ///< whatever does not grow with the plant
  double steel = 0, filler = 0, fluid = 0;  ///< [1/kg]
  std::optional<double> capsules;           ///< of the layers that melt; absent: as filler [1/kg]
  double pump = 0;                          ///< of a kilowatt of the pump's or fan's largest power [1/kW]
  double insulation = 0, foundation = 0;    ///< of a square metre of wall and roof, of ground [1/m^2]
  double operation = 0.02;                  ///< a year, share of the capital
  double interest = 0.07;                   ///< a year
  double lifetime = 25;                     ///< [years]
};
void declare(config::Section& section, EconomicsParameters& parameters);

/// What there is to pay for.
struct Inventory {
  double field_area = 0, block_power = 0;   ///< [m^2], electric [W]
  double steel = 0, filler = 0, fluid = 0;  ///< [kg]
  double insulated = 0, foundation = 0;     ///< [m^2]
  double capsules = 0;                      ///< not in filler [kg]
  double pump_power = 0;                    ///< largest of the run [W]
};

struct LevelisedCost {
  double capital = 0, storage = 0;  ///< all, and the tank with its contents and its pump
  double annuity = 0;               ///< share of the capital to pay back each year
  double per_year = 0;              ///< annuity and operation
  double per_energy = 0;            ///< [1/MWh]; infinite without electricity
};

/// (a + o) C / E with the annuity a = i (1 + i)^n/((1 + i)^n - 1), 1/n without interest; C the capital, o the
/// operation, E the electricity of a year [MWh].
LevelisedCost levelised_cost(const EconomicsParameters& prices, const Inventory& inventory,
                             double electricity);

}  // namespace couplet::thermocline
