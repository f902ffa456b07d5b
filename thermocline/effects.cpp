// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>

#include "thermocline/model/elements.hpp"

namespace couplet::thermocline {
namespace {

using P = ElementParameters;
using Card = diagnostics::EffectEntry<P>;

/// Reason why a tank has the effect, if it is `on`. Other elements have one effect each.
std::string when(const P& p, bool on, const char* reason) {
  return p.type == ElementParameters::Type::tank && on ? reason : "";
}

const std::array cards{
    Card{"resolved grains", "`bed.shells` above 1",
         [](const P& p) { return when(p, p.tank.bed.shells > 1, "bed.shells"); },
         "a temperature per shell of the grains of each cell",
         "delay within the grains over the passage of a front, and Biot number"},
    Card{"range of the film correlation", "`bed.closures.film-coefficient`",
         [](const P& p) { return when(p, p.tank.bed.closures.film_coefficient > 0, "film-coefficient"); }, "",
         "where Re is outside: width of the front that the film makes, over the bed"},
    Card{"conduction through the grains", "`bed.closures.conduction: stagnant`, the default",
         [](const P& p) {
           return when(p, p.tank.bed.closures.conduction == Conduction::stagnant, "bed.closures.conduction");
         },
         "", "width that it adds to a front, over the bed"},
    Card{"radiation between the grains", "`filler.emissivity` above 0, the default, in a gas",
         [](const P& p) {
           const bool conducts = p.tank.bed.closures.conduction == Conduction::stagnant;
           return when(p,
                       conducts && make_fluid(p.tank.fluid).is_transparent() && p.tank.filler.emissivity > 0,
                       "filler.emissivity");
         },
         "", "width that it adds to a front, over the bed"},
    Card{"mixing of inverted fluid", "`bed.mix-inversions`",
         [](const P& p) { return when(p, p.tank.bed.mix_inversions, "bed.mix-inversions"); }, "",
         "largest inversion over the run's range of temperatures"},
    Card{"pressure loss of the bed", "`pump`",
         [](const P& p) { return when(p, p.tank.pump.has_value(), "pump"); },
         "Ergun's equation in each bed step",
         "power of a pump or fan over the heat transported by the largest flow"},
    Card{"melting capsules", "`bed.layers[].melting`",
         [](const P& p) {
           const auto& layers = p.tank.bed.layers;
           return when(p,
                       std::any_of(layers.begin(), layers.end(), [](const BedLayer& l) { return l.melting; }),
                       "bed.layers[].melting");
         },
         "Newton's method for the heat of the shells of all cells"},
    Card{"yielding of the wall", "no key: not in the model", [](const P&) { return std::string(); }, "",
         "equivalent stress over the yield strength"},
    Card{"bending of the wall", "`external-wall`",
         [](const P& p) { return when(p, p.tank.external_wall.has_value(), "external-wall"); },
         "the processes solid_solver and coupler",
         "contribution of bending to the largest equivalent stress, over the stress of rings"},
    Card{"compressible flow of a gas", "no key: not in the model", [](const P&) { return std::string(); }, "",
         "speed between the grains over the speed of sound"},
    Card{"specific heat of a gas by its temperature", "no key: a constant, `fluid.specific-heat`",
         [](const P&) { return std::string(); }, "",
         "mean specific heat over the run's temperature range against the constant"},
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
