// SPDX-License-Identifier: Apache-2.0
#include "thermocline/judge/effects.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "common/diagnostics/effect_rows.hpp"
#include "thermocline/judge/effect_cards.hpp"

namespace couplet::thermocline {
namespace {

using P = ElementParameters;
using E = Evidence;
using V = std::optional<diagnostics::EffectFinding>;

V finding(double number, double limit, std::string what, std::string advice, double share) {
  if (std::isnan(number)) return {};
  return diagnostics::EffectFinding{
      .number = number, .limit = limit, .what = std::move(what), .advice = std::move(advice), .share = share};
}

// One temperature a grain takes a parabola inside it (linear driving force): 1/h becomes (1 + Bi/5)/h. Behind a
// front the fluid was measured (docs/stability.md) within 0.1 % of 20 shells at Bi 10, within 1.2 % at Bi 100.
V judge_grains(const P&, const E& e) {
  return finding(
      e.largest_biot, 20,
      fmt::format("Biot number of the grains = {:.2g}: their inside has {:.2g} of the film resistance",
                  e.largest_biot, e.largest_biot / 5),
      "set 'bed.shells': five resolve the grains", 1.2e-4 * e.largest_biot);
}

V judge_yield(const P&, const E& e) {
  return finding(e.share_of_yield, 1,
                 fmt::format("max equivalent stress / yield strength of the wall = {:.2g}", e.share_of_yield),
                 "the wall would yield: its stress and that of the grains are those of an elastic wall",
                 std::max(0., e.share_of_yield - 1));
}

// As a share of the strength, so that a wall that carries next to nothing is no reason for a word. Both shares grow only.
V judge_bending(const P&, const E& e) {
  if (std::isnan(e.share_with_bending)) return {};
  return diagnostics::EffectFinding{
      "", e.share_with_bending - e.share_as_rings, 0.1,
      fmt::format("max equivalent stress / yield strength of the wall: {:.3g} as rings, {:.3g} as a shell",
                  e.share_as_rings, e.share_with_bending),
      "reduce the factors of safety accordingly, or compute the wall as a solid ('external-wall')"};
}

V judge_sound(const P&, const E& e) {
  return finding(
      e.largest_mach, 0.3,
      fmt::format("gas speed between the grains / speed of sound = {:.2g} at the largest flow",
                  e.largest_mach),
      "the flow is compressible, and neither pressure loss nor films are valid: use less flow, a wider bed "
      "or a higher pressure",
      0.5 * e.largest_mach * e.largest_mach);
}

V judge_capacity(const P&, const E& e) {
  return finding(
      e.capacity_error, 0.05,
      fmt::format(
          "from the coldest to the hottest fluid of the run, air has {:.0f} J/(kg K), a difference of "
          "{:.2g} from the constant",
          e.mean_capacity, e.capacity_error),
      fmt::format("set 'fluid.specific-heat: {:.0f} J/(kg K)'", e.mean_capacity), e.capacity_error);
}

V judge_pressure(const P&, const E& e) {
  return finding(
      e.pumping_share, 0.02,
      fmt::format("pressure loss of {:.3g} kPa at the largest flow: {:.2g} of the transported heat",
                  1e-3 * e.pressure_loss, e.pumping_share),
      "add 'pump: {}', or check flow and grains: no real store is driven this hard", e.pumping_share);
}

// Cold fluid above hot sinks (docs/thermocline.md, inversions). How far that changes the answer depends on flow and
// grains: no share of the error.
V judge_mixing(const P&, const E& e) {
  if (std::isnan(e.inverted_share)) return {};
  return diagnostics::EffectFinding{
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
  return diagnostics::EffectFinding{
      "", e.driving_power / e.carried_heat, 0.1,
      fmt::format("pump or fan {:.3g} MW / transported heat {:.3g} MW = {:.2g} at the largest flow",
                  1e-6 * e.driving_power, 1e-6 * e.carried_heat, e.driving_power / e.carried_heat),
      "they consume half of the electricity or more: use less flow, a wider or lower bed, or larger grains"};
}

// First order in time: a front of speed v is spread as by a diffusion v^2 dt / 2, over the way H by sqrt(v dt H). Four
// hundred steps a crossing are 0.05 (and within 0.1 % of Schumann's gas bed, docs/validation/tank-tables.md).
V judge_implicit(const P&, const E& e) {
  if (std::isnan(e.implicit_spread)) return {};
  return diagnostics::EffectFinding{
      "", e.implicit_spread, 0.05,
      fmt::format("implicit advection with this step smears a front that crosses the bed over {:.2g} of its "
                  "height (standard deviation)",
                  e.implicit_spread),
      fmt::format("use 'simulation.time-step: {:.2g} s'", e.implicit_step)};
}

using Row = diagnostics::EffectRow<P, E>;
constexpr std::array rows{Row{"resolved grains", judge_grains},
                          Row{"implicit advection", judge_implicit, true},
                          Row{"mixing of inverted fluid", judge_mixing},
                          Row{"pressure loss of the bed", judge_pressure},
                          Row{"work of pump or fan", judge_driving, true},
                          Row{"yielding of the wall", judge_yield},
                          Row{"bending of the wall", judge_bending},
                          Row{"compressible flow of a gas", judge_sound},
                          Row{"specific heat of a gas by its temperature", judge_capacity}};

}  // namespace

std::vector<diagnostics::Finding> effect_findings(const ElementParameters& scene, const Evidence& evidence) {
  return diagnostics::effect_findings(std::span<const Row>(rows), effect_cards(), scene, evidence);
}

}  // namespace couplet::thermocline
