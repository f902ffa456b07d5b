// SPDX-License-Identifier: Apache-2.0
#include "thermocline/model/plausible.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace couplet::thermocline {
namespace {

/// `whose`: "any solid's".
std::string slip_in_heat(double specific_heat, const char* whose) {
  constexpr double least = 100;  // [J/(kg K)]
  if (!(specific_heat < least)) return "";
  return fmt::format(
      "specific-heat is {:g} J/(kg K), less than {}. A number without a unit is in J/(kg K); write '{:g} "
      "kJ/(kg K)' if that is intended",
      specific_heat, whose, specific_heat);
}

}  // namespace

std::string slip_in_bed(const BedParameters& bed, double diameter) {
  constexpr double largest_grain = 1;  // [m]
  for (std::size_t i = 0; i < bed.layers.size(); ++i) {
    const BedLayer& layer = bed.layers[i];
    if (const std::string slip = layer.filler ? slip_in_filler(*layer.filler) : ""; !slip.empty())
      return fmt::format("layers[{}].filler.{}", i, slip);
    const double most = std::min(diameter, largest_grain);
    if (layer.porosity < 1 && layer.diameter >= most)
      return fmt::format(
          "layers[{}].diameter is {:g} m: expected grains in a tank of {:g} m to be smaller than {:g} m. A "
          "number without a unit is in metres; write '{:g} mm' if that is intended",
          i, layer.diameter, diameter, most, layer.diameter);
    constexpr double least_latent_heat = 1000;  // [J/kg]; what melts takes a hundred times as much
    if (layer.melting && layer.melting->latent_heat > 0 && layer.melting->latent_heat < least_latent_heat)
      return fmt::format(
          "layers[{}].melting.latent-heat is {:g} J/kg, less than the sensible heat of one kelvin. A number "
          "without a unit is in J/kg; write '{:g} kJ/kg' if that is intended",
          i, layer.melting->latent_heat, layer.melting->latent_heat);
  }
  return "";
}

std::string slip_in_tank(const BedParameters& bed, double diameter) {
  constexpr double largest = 300;  // [m]
  double height = 0;
  for (const BedLayer& layer : bed.layers) height += layer.height;
  if (diameter <= largest && height <= largest) return "";
  return fmt::format(
      "a bed {:g} m high in a tank of {:g} m: expected {:g} m at most. A number without a unit is in metres",
      height, diameter, largest);
}

std::string slip_in_filler(const Filler& f) {
  constexpr double lightest = 50, heaviest = 25000;  // SI; a conductivity may be as large as one likes
  if (f.density < lightest || f.density > heaviest)
    return fmt::format(
        "density is {:g} kg/m^3: expected {:g} to {:g}. A number without a unit is in kg/m^3; write '{:g} "
        "kg/l' if that is intended",
        f.density, lightest, heaviest, f.density);
  return slip_in_heat(f.specific_heat, "any solid's");
}

std::string slip_in_fluid(const FluidParameters& p, Advection advection) {
  if (p.type != FluidParameters::Type::custom) return "";
  constexpr double lightest_liquid = 50;  // [kg/m^3]
  if (std::string slip = slip_in_heat(p.specific_heat, "any fluid's"); !slip.empty()) return slip;
  if (p.density < lightest_liquid && advection != Advection::implicit)
    return fmt::format(
        "density is {:g} kg/m^3, that of a gas, which needs bed.advection: implicit. A number without a "
        "unit is in kg/m^3; write '{:g} kg/l' if that is intended",
        p.density, p.density);
  return "";
}

std::string slip_in_plates(const ShellParameters& shell, double diameter) {
  constexpr double thinnest_wall = 0.1;  // of the diameter; beyond it the wall is no shell
  for (std::size_t i = 0; i < shell.plates.size(); ++i)
    if (shell.plates[i].thickness > thinnest_wall * diameter)
      return fmt::format(
          "plates[{}].thickness is {:g} m in a tank of {:g} m: a shell is at most a tenth of the diameter "
          "thick. A number without a unit is in metres; write '{:g} mm' if that is intended",
          i, shell.plates[i].thickness, diameter, shell.plates[i].thickness);
  return "";
}

std::string slip_in_insulation(const InsulationParameters& insulation, double diameter) {
  const double most =
      std::max(1.0, diameter / 2);  // a small tank may have a blanket thicker than its radius [m]
  if (insulation.thickness <= most) return "";
  return fmt::format(
      "thickness is {:g} m around a tank of {:g} m: expected {:g} m at most. A number without a unit is in "
      "metres; write '{:g} cm' if that is intended",
      insulation.thickness, diameter, most, insulation.thickness);
}

std::string slip_in_ground(const GroundParameters& ground) {
  constexpr double thickest_foundation = 10;  // [m]
  for (std::size_t i = 0; i < ground.layers.size(); ++i) {
    const GroundLayer& layer = ground.layers[i];
    if (layer.material != "soil" && layer.thickness > thickest_foundation)
      return fmt::format(
          "layers[{}].thickness is {:g} m of {}: expected at most {:g} m, except for soil. A number without "
          "a unit is in metres; write '{:g} cm' if that is intended",
          i, layer.thickness, layer.material, thickest_foundation, layer.thickness);
  }
  return "";
}

std::string slip_in_plant(const PlantParameters& plant) {
  constexpr double smallest_block = 1000;  // [W]
  if (plant.electric_power >= smallest_block) return "";
  return fmt::format(
      "electric-power is {:g} W: expected at least {:g} W. A number without a unit is in W; write '{:g} MW' "
      "if that is intended",
      plant.electric_power, smallest_block, plant.electric_power);
}

}  // namespace couplet::thermocline
