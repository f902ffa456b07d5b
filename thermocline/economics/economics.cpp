// SPDX-License-Identifier: Apache-2.0
#include "thermocline/economics/economics.hpp"

#include <cmath>
#include <limits>

namespace couplet::thermocline {

void declare(config::Section& s, EconomicsParameters& p) {
  s.value("field", p.field).not_negative().doc("price per square metre of solar field");
  s.value("block", p.block).not_negative().doc("price per kilowatt (electric) of the power block");
  s.value("fixed", p.fixed).not_negative().doc("fixed cost, independent of the plant's size");
  s.value("steel", p.steel).not_negative().doc("price per kilogram of the tank's wall");
  s.value("filler", p.filler).not_negative().doc("price per kilogram of the grains");
  s.value("capsules", p.capsules)
      .not_negative()
      .doc("price per kilogram of capsules, the grains of phase-change layers; absent: as filler");
  s.value("pump", p.pump)
      .not_negative()
      .doc("price per kilowatt of pump or fan, by the largest power in the run");
  s.value("fluid", p.fluid).not_negative().doc("price per kilogram of the fluid in the bed");
  s.value("insulation", p.insulation).not_negative().doc("price per square metre of insulated wall and roof");
  s.value("foundation", p.foundation).not_negative().doc("price per square metre of the tank's ground");
  s.value("operation", p.operation).range(0, 1).doc("annual cost, as a share of the capital");
  s.value("interest", p.interest).range(0, 1).doc("annual interest rate");
  s.value("lifetime", p.lifetime).range(1, 200).doc("lifetime in years");
  s.check(
      [&] {
        return p.field + p.block + p.fixed + p.steel + p.filler + p.capsules.value_or(0) + p.pump + p.fluid +
                           p.insulation + p.foundation >
                       0
                   ? ""
                   : "all prices are 0: the levelised cost is undefined";
      },
      "");
}

LevelisedCost levelised_cost(const EconomicsParameters& p, const Inventory& i, double electricity) {
  LevelisedCost cost;
  cost.storage = p.steel * i.steel + p.filler * i.filler + p.capsules.value_or(p.filler) * i.capsules +
                 p.fluid * i.fluid + p.insulation * i.insulated + p.foundation * i.foundation +
                 p.pump * i.pump_power / 1000;
  cost.capital = p.fixed + p.field * i.field_area + p.block * i.block_power / 1000 + cost.storage;
  const double grown = std::pow(1 + p.interest, p.lifetime);
  cost.annuity = p.interest > 0 ? p.interest * grown / (grown - 1) : 1 / p.lifetime;
  cost.per_year = (cost.annuity + p.operation) * cost.capital;
  cost.per_energy = electricity > 0 ? cost.per_year / electricity : std::numeric_limits<double>::infinity();
  return cost;
}

}  // namespace couplet::thermocline
