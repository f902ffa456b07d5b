// SPDX-License-Identifier: Apache-2.0
#include "thermocline/judge/effect_cards.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace couplet::thermocline {
namespace {

using P = ElementParameters;

/// Of a tank only; other elements have one effect each.
std::string when(const P& p, bool on, const char* reason) {
  return p.type == ElementParameters::Type::tank && on ? reason : "";
}

using E = Evidence;
using V = std::optional<effects::EffectVerdict>;

// One temperature a grain takes a parabola inside it (linear driving force): 1/h becomes (1 + Bi/5)/h. Behind a
// front the fluid was measured (docs/stability.md) within 0.1 % of 20 shells at Bi 10, within 1.2 % at Bi 100.
V judge_grains(const P&, const E& e) {
  return effects::verdict(
      e.largest_biot, 20,
      fmt::format("Biot number of the grains = {:.2g}: their inside has {:.2g} of the film resistance",
                  e.largest_biot, e.largest_biot / 5),
      "set 'bed.shells': five resolve the grains", 1.2e-4 * e.largest_biot);
}

V judge_yield(const P&, const E& e) {
  return effects::verdict(
      e.share_of_yield, 1,
      fmt::format("max equivalent stress / yield strength of the wall = {:.2g}", e.share_of_yield),
      "the wall would yield: its stress and that of the grains are those of an elastic wall",
      std::max(0., e.share_of_yield - 1));
}

// As a share of the strength, so that a wall that carries next to nothing is no reason for a word. Both shares grow only.
V judge_bending(const P&, const E& e) {
  if (std::isnan(e.share_with_bending)) return {};
  return effects::EffectVerdict{
      "", e.share_with_bending - e.share_as_rings, 0.1,
      fmt::format("max equivalent stress / yield strength of the wall: {:.3g} as rings, {:.3g} as a shell",
                  e.share_as_rings, e.share_with_bending),
      "reduce the factors of safety accordingly, or compute the wall as a solid ('external-wall')"};
}

V judge_sound(const P&, const E& e) {
  return effects::verdict(
      e.largest_mach, 0.3,
      fmt::format("gas speed between the grains / speed of sound = {:.2g} at the largest flow",
                  e.largest_mach),
      "the flow is compressible, and neither pressure loss nor films are valid: use less flow, a wider bed "
      "or a higher pressure",
      0.5 * e.largest_mach * e.largest_mach);
}

V judge_capacity(const P&, const E& e) {
  return effects::verdict(
      e.capacity_error, 0.05,
      fmt::format(
          "from the coldest to the hottest fluid of the run, air has {:.0f} J/(kg K), a difference of "
          "{:.2g} from the constant",
          e.mean_capacity, e.capacity_error),
      fmt::format("set 'fluid.specific-heat: {:.0f} J/(kg K)'", e.mean_capacity), e.capacity_error);
}

V judge_pressure(const P&, const E& e) {
  return effects::verdict(
      e.pumping_share, 0.02,
      fmt::format("pressure loss of {:.3g} kPa at the largest flow: {:.2g} of the transported heat",
                  1e-3 * e.pressure_loss, e.pumping_share),
      "add 'pump: {}', or check flow and grains: no real store is driven this hard", e.pumping_share);
}

// Cold fluid above hot sinks (docs/thermocline.md, inversions). How far that changes the answer depends on flow and
// grains: no share of the error.
V judge_mixing(const P&, const E& e) {
  if (std::isnan(e.inverted_share)) return {};
  return effects::EffectVerdict{
      "", e.inverted_share, 0.05,
      fmt::format("fluid {:.3g} K colder than the fluid below it: {:.2g} of the run's range", e.inversion,
                  e.inverted_share),
      "it would sink: set 'bed.mix-inversions: true', or check the signs of the mass flows (upward above 0) "
      "and the inlet temperatures"};
}

// A power block makes some 0.4 of the heat electricity, and pump or fan run in charge and in discharge: a tenth of the heat
// is half of all that is sold.
V judge_driving(const P&, const E& e) {
  if (std::isnan(e.driving_power)) return {};
  return effects::EffectVerdict{
      "", e.driving_power / e.carried_heat, 0.1,
      fmt::format("pump or fan {:.3g} MW / transported heat {:.3g} MW = {:.2g} at the largest flow",
                  1e-6 * e.driving_power, 1e-6 * e.carried_heat, e.driving_power / e.carried_heat),
      "they consume half of the electricity or more: use less flow, a wider or lower bed, or larger grains"};
}

// First order in time: a front of speed v is spread as by a diffusion v^2 dt / 2, over the way H by sqrt(v dt H). Four
// hundred steps a crossing are 0.05 (and within 0.1 % of Schumann's gas bed, docs/validation/tank-tables.md).
V judge_implicit(const P&, const E& e) {
  if (std::isnan(e.implicit_spread)) return {};
  return effects::EffectVerdict{
      "", e.implicit_spread, 0.05,
      fmt::format("implicit advection with this step smears a front that crosses the bed over {:.2g} of its "
                  "height (standard deviation)",
                  e.implicit_spread),
      fmt::format("use 'simulation.time-step: {:.2g} s'", e.implicit_step)};
}

const std::array cards{
    Card{"resolved grains", "`bed.shells` above 1",
         [](const P& p) { return when(p, p.tank.bed.shells > 1, "bed.shells"); },
         "a temperature per shell of the grains of each cell", "Biot number of the grains, 20", judge_grains},
    Card{"implicit advection", "`bed.advection: implicit`",
         [](const P& p) { return when(p, p.tank.bed.advection == Advection::implicit, "bed.advection"); }, "",
         "smearing of a front by the step, over the bed's height, 0.05", judge_implicit, true},
    Card{"mixing of inverted fluid", "`bed.mix-inversions`",
         [](const P& p) { return when(p, p.tank.bed.mix_inversions, "bed.mix-inversions"); }, "",
         "largest inversion over the run's range of temperatures, 0.05", judge_mixing},
    Card{"pressure loss of the bed", "`pump`",
         [](const P& p) { return when(p, p.tank.pump.has_value(), "pump"); },
         "Ergun's equation in each bed step",
         "power of a pump or fan over the heat transported by the largest flow, 0.02", judge_pressure},
    Card{"work of pump or fan", "`pump`", [](const P& p) { return when(p, p.tank.pump.has_value(), "pump"); },
         "", "power of pump or fan over the heat transported by the largest flow, 0.1", judge_driving, true},
    Card{"melting capsules", "`bed.layers[].melting`",
         [](const P& p) {
           const auto& layers = p.tank.bed.layers;
           return when(p,
                       std::any_of(layers.begin(), layers.end(), [](const BedLayer& l) { return l.melting; }),
                       "bed.layers[].melting");
         },
         "Newton's method for the heat of the shells of all cells"},
    Card{"yielding of the wall", "no key: not in the model", [](const P&) { return std::string(); }, "",
         "equivalent stress over the yield strength, 1", judge_yield},
    Card{"bending of the wall", "`external-wall`",
         [](const P& p) { return when(p, p.tank.external_wall.has_value(), "external-wall"); },
         "the processes solid_solver and coupler",
         "contribution of bending to the largest equivalent stress, over the yield strength, 0.1",
         judge_bending},
    Card{"compressible flow of a gas", "no key: not in the model", [](const P&) { return std::string(); }, "",
         "speed between the grains over the speed of sound, 0.3", judge_sound},
    Card{"specific heat of a gas by its temperature", "no key: a constant, `fluid.specific-heat`",
         [](const P&) { return std::string(); }, "",
         "mean specific heat over the run's temperature range against the constant, 0.05", judge_capacity},
    Card{"shell", "`shell`", [](const P& p) { return when(p, p.tank.shell.has_value(), "shell"); },
         "rings: temperature and stress"},
    Card{"filler mechanics", "`filler-mechanics`",
         [](const P& p) { return when(p, p.tank.mechanics.has_value(), "filler-mechanics"); },
         "contact and slip per ring"},
    Card{"wall as a solid", "`external-wall`",
         [](const P& p) { return when(p, p.tank.external_wall.has_value(), "external-wall"); },
         "the processes solid_solver and coupler"},
    Card{"insulation", "`insulation`",
         [](const P& p) { return when(p, p.tank.insulation.has_value(), "insulation"); },
         "layers of the blanket per ring"},
    Card{"ullage", "`ullage`", [](const P& p) { return when(p, p.tank.ullage.has_value(), "ullage"); },
         "gas, roof and radiation between the bed and the roof"},
    Card{"ground", "`ground`", [](const P& p) { return when(p, p.tank.ground.has_value(), "ground"); },
         "a column of cells"},
    Card{"elements elsewhere", "`elsewhere`",
         [](const P& p) { return when(p, p.tank.elsewhere.has_value(), "elsewhere"); },
         "one process each, and the coupler"},
    Card{"weather", "`ambient` with a file or a clear sky",
         [](const P& p) { return when(p, p.tank.ambient.kind != WeatherKind::constant, "ambient"); },
         "hours of the year"},
    Card{"day report", "`report`", [](const P& p) { return when(p, p.tank.report.has_value(), "report"); },
         "days.csv"},
};

}  // namespace

std::span<const Card> effect_cards() { return cards; }

}  // namespace couplet::thermocline
