// SPDX-License-Identifier: Apache-2.0
#include "common/diagnostics/prices.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>

namespace couplet::diagnostics {
namespace {

const char* scenes_of(int dimension) { return dimension == 2 ? "2-D: " : dimension == 3 ? "3-D: " : ""; }

/// Text "a to b", "a" if both are equal, "up to b" from zero.
std::string spread_text(const std::string& least, const std::string& most, bool from_nothing) {
  if (from_nothing) return "up to " + most;
  return least == most ? most : least + " to " + most;
}

}  // namespace

std::vector<Price> prices_of(std::string_view program, std::string_view effect) {
  std::vector<Price> found;
  std::ranges::copy_if(price_list(), std::back_inserter(found),
                       [&](const Price& p) { return p.program == program && p.effect == effect; });
  return found;
}

std::string memory_text(const Price& price) {
  if (!(price.bytes.most > 0)) return "";
  return spread_text(fmt::format("{:g}", price.bytes.least), fmt::format("{:g}", price.bytes.most),
                     price.bytes.least == 0);
}

std::string time_text(const Price& price) {
  if (!(price.step.most > 0)) return "";
  return spread_text(fmt::format("{:+.0f}", 100 * price.step.least),
                     fmt::format("{:+.0f}", 100 * price.step.most), price.step.least == 0);
}

std::string price_text(const Price& price) {
  const std::string memory = memory_text(price), time = time_text(price);
  if (memory.empty() && time.empty()) return "";
  return fmt::format("{}{}{}{}{}{}", scenes_of(price.dimension), memory, memory.empty() ? "" : " B per cell",
                     memory.empty() || time.empty() ? "" : ", ", time, time.empty() ? "" : " % of a step");
}

std::string column(const std::vector<Price>& prices, std::string (*text)(const Price&), const char* unit) {
  if (prices.empty()) return "";
  std::string cell;
  for (const Price& p : prices)
    if (const std::string one = text(p); !one.empty())
      cell += fmt::format("{}{}{} {}", cell.empty() ? "" : "; ", scenes_of(p.dimension), one, unit);
  return cell.empty() ? "next to none" : cell;
}

double saved_share(std::string_view program, std::string_view effect) {
  const std::vector<Price> prices = prices_of(program, effect);
  if (prices.empty()) return 0;
  const double share = std::ranges::min(prices, {}, [](const Price& p) { return p.step.least; }).step.least;
  return share / (1 + share);
}

namespace {

// Program, effect, dimension, bytes per cell, share of a step.
constexpr auto prices = std::to_array<Price>({
    // clang-format off
    // begin: written by scripts/prices
    {"fluid_solver", "body force", 2, {64, 69}, {0.064, 0.088}},
    {"fluid_solver", "body force", 3, {46, 98}, {0, 0.067}},
    {"fluid_solver", "energy budget", 2, {0, 20}, {0.052, 0.084}},
    {"fluid_solver", "energy budget", 3, {0, 38}, {0.031, 0.072}},
    {"fluid_solver", "gaps that close", 2, {72, 85}, {0, 0}},
    {"fluid_solver", "gaps that close", 3, {50, 61}, {0, 0}},
    {"fluid_solver", "immersed bodies", 2, {230, 250}, {0.5, 0.71}},
    {"fluid_solver", "immersed bodies", 3, {290, 420}, {0.21, 0.4}},
    {"fluid_solver", "moving frame", 2, {330, 330}, {0.19, 0.41}},
    {"fluid_solver", "moving frame", 3, {760, 760}, {0.26, 1.1}},
    {"fluid_solver", "rotating frame", 2, {32, 60}, {0.062, 0.11}},
    {"fluid_solver", "rotating frame", 3, {0, 59}, {0, 0.13}},
    {"fluid_solver", "running statistics", 2, {130, 160}, {0.03, 0.046}},
    {"fluid_solver", "running statistics", 3, {150, 200}, {0, 0.059}},
    {"fluid_solver", "turbulence model", 2, {76, 96}, {0.57, 1}},
    {"fluid_solver", "turbulence model", 3, {35, 120}, {0.42, 1.1}},
    {"fluid_solver", "waves of pressure", 2, {81, 98}, {0.1, 0.6}},
    {"fluid_solver", "waves of pressure", 3, {77, 99}, {0.34, 0.35}},
    {"solid_solver", "body force", 2, {32, 46}, {0.051, 0.075}},
    {"solid_solver", "body force", 3, {64, 85}, {0.041, 0.11}},
    {"solid_solver", "conduction of heat", 2, {1800, 2800}, {0, 0}},
    {"solid_solver", "conduction of heat", 3, {4200, 10000}, {0, 0.037}},
    {"solid_solver", "energies", 2, {48, 58}, {0.086, 0.14}},
    {"solid_solver", "energies", 3, {84, 110}, {0.061, 0.13}},
    {"solid_solver", "geometric non-linearity", 2, {0, 0}, {2.7, 3.8}},
    {"solid_solver", "geometric non-linearity", 3, {1800, 2200}, {4.8, 6.4}},
    {"solid_solver", "gravity", 2, {20, 22}, {0, 0}},
    {"solid_solver", "gravity", 3, {37, 46}, {0, 0}},
    {"solid_solver", "near incompressibility", 2, {55, 650}, {0.042, 0.11}},
    {"solid_solver", "near incompressibility", 3, {57, 76}, {0.11, 0.23}},
    {"solid_solver", "orthotropic elasticity", 2, {94, 110}, {0, 0}},
    {"solid_solver", "orthotropic elasticity", 3, {590, 1200}, {0.25, 0.31}},
    {"solid_solver", "structural damping", 2, {0, 0}, {0, 0}},
    {"solid_solver", "structural damping", 3, {0, 0}, {0, 0}},
    {"solid_solver", "thermal strain", 2, {110, 120}, {0.037, 0.048}},
    {"solid_solver", "thermal strain", 3, {140, 200}, {0, 0.038}},
    {"mesh_mover", "elastic mesh motion", 2, {4900, 6600}, {4.4, 6.1}},
    {"mesh_mover", "elastic mesh motion", 3, {0, 41}, {7.8, 34}},
    {"mesh_mover", "incremental mesh motion", 2, {200, 260}, {6.7, 6.8}},
    {"mesh_mover", "incremental mesh motion", 3, {0, 120}, {6.4, 11}},
    {"mesh_mover", "mesh motion by a barrier", 2, {850, 2900}, {4.4, 10}},
    {"mesh_mover", "mesh motion by a barrier", 3, {1100, 10000}, {9.5, 28}},
    {"mesh_mover", "rotations carried into the mesh", 2, {0, 0}, {0, 0}},
    {"mesh_mover", "rotations carried into the mesh", 3, {0, 0}, {0, 0}},
    {"plate_modal", "contact with a seat", 2, {72, 88}, {0.097, 0.15}},
    {"plate_modal", "damping", 2, {0, 0}, {0, 0}},
    {"plate_modal", "pressures of the case", 2, {810, 2300}, {0, 0}},
    {"thermocline", "filler mechanics", 1, {160, 190}, {0.032, 0.071}},
    {"thermocline", "ground", 1, {0, 0}, {0.078, 0.89}},
    {"thermocline", "implicit advection", 1, {0, 0}, {0, 0}},
    {"thermocline", "insulation", 1, {460, 510}, {0.14, 0.25}},
    {"thermocline", "resolved grains", 1, {60, 63}, {0.15, 0.27}},
    {"thermocline", "shell", 1, {440, 570}, {0.088, 0.22}},
    {"thermocline", "ullage", 1, {95, 130}, {0.36, 0.39}},
    // end
    // clang-format on
});

}  // namespace

std::span<const Price> price_list() { return prices; }

}  // namespace couplet::diagnostics
