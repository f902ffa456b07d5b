// SPDX-License-Identifier: Apache-2.0
#include "common/app/case/wall_mass.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <optional>

#include "common/base/error.hpp"
#include "common/base/units.hpp"

namespace couplet::app {
namespace {

// A side that is wet alone has the whole mass, and where the fluid is heavy less converges better.
constexpr double most = 3;

/// In SI; none where the key is not there or cannot be read, which is reported elsewhere.
std::optional<double> number(const config::Document& document, const std::string& key, const char* unit) {
  const auto text = config::text_of(document, key);
  if (!text) return {};
  try {
    return base::parse_quantity(*text, unit);
  } catch (const Error&) {
    return {};
  }
}

/// Largest density times thickness of the plate and its zones [kg/m^2].
double mass_of(const config::Document& document, const std::string& plate) {
  const auto density = number(document, plate + ".material.density", "kg/m^3"),
             thickness = number(document, plate + ".thickness", "m");
  double largest = density.value_or(0) * thickness.value_or(0);
  for (const std::string& zone : config::keys_of(document, plate + ".zones")) {
    const std::string key = plate + ".zones." + zone;
    const auto own_density = number(document, key + ".density", "kg/m^3"),
               own_thickness = number(document, key + ".thickness", "m");
    largest = std::max(
        largest, own_density.value_or(density.value_or(0)) * own_thickness.value_or(thickness.value_or(0)));
  }
  return largest;
}

}  // namespace

std::vector<std::string> doubts_of_wall_mass(const config::Document& document) {
  const auto fluid = config::text_of(document, "coupling.fluid.participant"),
             structure = config::text_of(document, "coupling.structure.participant");
  if (!fluid || !structure) return {};
  const std::string plate = "participants." + *structure;
  if (config::text_of(document, plate + ".program") != "plate_modal") return {};
  const double mass = mass_of(document, plate);
  if (!(mass > 0)) return {};
  std::vector<std::string> doubts;
  const std::string walls = "participants." + *fluid + ".boundaries";
  for (const std::string& patch : config::keys_of(document, walls)) {
    const std::string key = fmt::format("{}.{}.surface-density", walls, patch);
    if (const auto given = number(document, key, "kg/m^2"); given && *given > most * mass)
      doubts.push_back(fmt::format(
          "{}: {:.6g} kg/m^2, but the plate '{}' has {:.3g} kg/m^2, density times thickness: implausible; "
          "check the number and its unit.",
          config::where(document, key), *given, *structure, mass));
  }
  return doubts;
}

}  // namespace couplet::app
