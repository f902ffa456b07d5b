// SPDX-License-Identifier: Apache-2.0
#include "thermocline/model/parameters.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "common/base/text.hpp"
#include "thermocline/bed/grain_kernels.hpp"
#include "thermocline/model/plausible.hpp"
#include "thermocline/model/questions.hpp"

namespace couplet::thermocline {
namespace {

void declare_closures(config::Section& s, ClosureParameters& p) {
  s.choice("conduction", p.conduction,
           {{"wakao", Conduction::wakao},
            {"molecular", Conduction::molecular},
            {"stagnant", Conduction::stagnant},
            {"constant", Conduction::constant}})
      .doc(
          "axial conduction: 0.7 eps k + 0.5 Re Pr k; eps k; the stagnant bed of Zehner and Schluender with "
          "dispersion; or given");
  s.value("conductivity", p.conductivity)
      .unit("W/(m K)")
      .plausible(1e-3, 1e4)
      .not_negative()
      .doc("conductivity, with conduction: constant");
  s.choice("wall-film", p.wall_film,
           {{"beek", WallFilm::beek}, {"yagi-wakao", WallFilm::yagi_wakao}, {"constant", WallFilm::constant}})
      .doc("heat transfer between fluid and wall; the correlations add to 2 k0/d of the stagnant bed");
  s.value("wall-coefficient", p.wall_coefficient)
      .unit("W/(m^2 K)")
      .plausible(1e-3, 1e7)
      .not_negative()
      .doc("wall film coefficient, with wall-film: constant");
  s.value("film-coefficient", p.film_coefficient)
      .unit("W/(m^2 K)")
      .plausible(1e-3, 1e7)
      .not_negative()
      .doc("film between fluid and grains; 0: Nu = 2 + 1.1 Pr^(1/3) Re^0.6");
}

std::string problem_of_profile(const BedParameters& p) {
  if (p.profile_z.size() != p.profile_temperature.size()) return "needs as many values as profile-z";
  const bool grows = std::is_sorted(p.profile_z.begin(), p.profile_z.end(), std::less_equal<>());
  return grows ? "" : "profile-z must increase from value to value";
}

void check_together(config::Section& s, TankParameters& p) {
  s.check([&p] { return p.mechanics && !p.shell ? "requires a shell; add one" : ""; }, "filler-mechanics");
  s.check(
      [&p] {
        return p.external_wall && !(p.shell && p.mechanics) ? "requires shell and filler-mechanics" : "";
      },
      "external-wall");
  s.check(
      [&p] {
        return p.report && p.flow.type != FlowParameters::Type::plant
                   ? "requires a plant: set flow: {type: plant, ...} or remove it"
                   : "";
      },
      "report");
  s.check(
      [&p] {
        const PlantParameters& plant = p.flow.plant;
        return p.report && p.flow.type == FlowParameters::Type::plant && plant.hot > plant.cold &&
                       p.report->thickness_margin >= 0.5 * (plant.hot - plant.cold)
                   ? fmt::format(
                         "thickness-margin is {:g} K, half of the difference between cold and hot ({:g} K) "
                         "or more: nothing is left between the two critical temperatures",
                         p.report->thickness_margin, plant.hot - plant.cold)
                   : "";
      },
      "report");
  s.check(
      [&p]() -> std::string {
        if (!p.elsewhere) return "";
        if (p.elsewhere->ground && p.ground)
          return "specifies that the ground is elsewhere; remove "
                 "'ground' here";
        if (p.elsewhere->insulation && p.insulation)
          return "specifies that the insulation is elsewhere; remove 'insulation' here";
        return p.elsewhere->insulation && !p.shell ? "requires a shell inside the insulation" : "";
      },
      "elsewhere");
  s.check([&p] { return p.insulation && !p.shell ? "requires a shell; add one" : ""; }, "insulation");
  s.check(
      [&p] {
        return p.fluid.type == FluidParameters::Type::air && p.bed.advection != Advection::implicit
                   ? "a gas crosses a cell in milliseconds: set bed.advection: implicit"
                   : "";
      },
      "bed");
  s.check([&p] { return forgotten_unit_of_bed(p); }, "bed");
  s.check([&p] { return forgotten_unit_of_flow(p); }, "flow");
  s.check([&p] { return slip_in_tank(p.bed, p.diameter); }, "diameter");
  s.check([&p] { return slip_in_fluid(p.fluid, p.bed.advection); }, "fluid");
  s.check([&p] { return slip_in_filler(p.filler); }, "filler");
  s.check([&p] { return slip_in_bed(p.bed, p.diameter); }, "bed");
  s.check([&p] { return p.shell ? slip_in_plates(*p.shell, p.diameter) : ""; }, "shell");
  s.check([&p] { return p.insulation ? slip_in_insulation(*p.insulation, p.diameter) : ""; }, "insulation");
  s.check([&p] { return p.ground ? slip_in_ground(*p.ground) : ""; }, "ground");
  s.check([&p] { return season_without_dates(p); }, "flow");
  s.check([&p] { return p.flow.type == FlowParameters::Type::plant ? slip_in_plant(p.flow.plant) : ""; },
          "flow");
}

}  // namespace

void declare(config::Section& section, BedParameters& p) {
  section.value("cells", p.cells)
      .range(1, 1e6)
      .doc("number of cells along z; layers begin and end at cell faces");
  section.list<BedLayer>(
      "layers", p.layers,
      [](config::Section& s, BedLayer& l) {
        s.value("height", l.height).unit("m").plausible(0.01, 100).positive().required().doc("height");
        s.value("porosity", l.porosity)
            .range(0.01, 1)
            .required()
            .doc(
                "volume fraction of the fluid; 1: no "
                "filler");
        s.value("diameter", l.diameter)
            .unit("m")
            .plausible(1e-4, 1)
            .positive()
            .required()
            .doc("effective diameter of the grains");
        s.optional_section<Filler>(
            "filler", l.filler, [](config::Section& q, Filler& v) { declare(q, v); },
            "grains of this layer, if different from those of the tank");
        s.optional_section<Melting>(
            "melting", l.melting, [](config::Section& q, Melting& v) { declare(q, v); },
            "phase-change capsules with the density, specific heat and conductivity of 'filler'");
        s.check(
            [&l] {
              return l.melting && l.porosity >= 1
                         ? "a layer of fluid only (porosity 1) has no capsules that could melt"
                         : "";
            },
            "melting");
      },
      "from the bottom up");
  section.value("shells", p.shells)
      .range(1, most_shells)
      .doc("number of shells of equal volume in a grain; 1: linear driving force");
  section
      .choice("advection", p.advection,
              {{"upwind", Advection::upwind}, {"tvd", Advection::tvd}, {"implicit", Advection::implicit}})
      .doc(
          "upwind: explicit, first order, as in the thesis; tvd: explicit, second order; implicit: upwind, "
          "any step");
  section.value("courant", p.courant)
      .range(1e-4, 0.95)
      .doc(
          "step of the bed over the time that the fluid takes through the cell with the least fluid; tvd: "
          "at most 0.5");
  section.value("conducting-inlet", p.conducting_inlet)
      .doc("heat conduction through the inlet's face as well");
  section.value("mix-inversions", p.mix_inversions)
      .doc("fluid that is colder than the fluid below it is mixed with it");
  section.section(
      "closures", [&p](config::Section& s) { declare_closures(s, p.closures); }, "transfer coefficients");
  section.value("initial-temperature", p.initial_temperature)
      .unit("K")
      .plausible(70, 5000)
      .positive()
      .doc("initial temperature of fluid and filler");
  section.value("profile-z", p.profile_z)
      .unit("m")
      .plausible(1e-4, 300)
      .doc("heights of an initial profile, instead of one temperature");
  section.value("profile-temperature", p.profile_temperature)
      .unit("K")
      .plausible(70, 5000)
      .doc("temperatures of the profile, piecewise linear");
  section.check([&p] { return p.layers.empty() ? "at least one layer is needed" : ""; }, "layers");
  section.check(
      [&p] {
        const bool melts =
            std::any_of(p.layers.begin(), p.layers.end(), [](const BedLayer& l) { return l.melting; });
        return melts && p.advection == Advection::tvd
                   ? "tvd does not support phase-change layers; use upwind or implicit"
                   : "";
      },
      "advection");
  section.check([&p] { return problem_of_profile(p); }, "profile-temperature");
  section.check(
      [&p] {
        return p.advection == Advection::tvd && p.courant > 0.5
                   ? "is at most 0.5 with advection: tvd, the limit for boundedness"
                   : "";
      },
      "courant");
}

void declare(config::Section& section, ShellParameters& p) {
  section.section(
      "material", [&p](config::Section& s) { declare(s, p.material); }, "metal of the shell");
  section.list<Plate>(
      "plates", p.plates,
      [](config::Section& s, Plate& l) {
        s.value("height", l.height).unit("m").plausible(0.01, 100).positive().required().doc("height");
        s.value("thickness", l.thickness)
            .unit("m")
            .plausible(1e-4, 30)
            .positive()
            .required()
            .doc("thickness");
      },
      "from the bottom up; the last one continues to the top");
  section.value("roof-pressure", p.roof_pressure)
      .unit("Pa")
      .plausible(1, 1e6)
      .not_negative()
      .doc("weight of the roof per roof area");
  section.check([&p] { return p.plates.empty() ? "at least one plate is needed" : ""; }, "plates");
}

void declare(config::Section& section, InsulationParameters& p) {
  section.section(
      "material", [&p](config::Section& s) { declare(s, p.material); }, "of the blanket");
  section.value("thickness", p.thickness)
      .unit("m")
      .plausible(1e-4, 30)
      .positive()
      .required()
      .doc("thickness on the side, and on the roof above an ullage");
  section.value("cells", p.cells).range(1, 200).doc("number of cells through the thickness");
  section.value("step", p.step).unit("s").plausible(0.1, 1e5).positive().doc("time step of the insulation");
  section.value("cover-emissivity", p.outside.emissivity).range(0, 1).doc("emissivity of the metal cover");
  section.value("solar-absorptance", p.outside.solar_absorptance)
      .range(0, 1)
      .doc("solar absorptance of the cover; 0: sun neglected");
}

void declare(config::Section& section, GroundParameters& p) {
  section.list<GroundLayer>(
      "layers", p.layers,
      [](config::Section& s, GroundLayer& l) {
        s.value("material", l.material).required().doc(base::join(foundation_materials()));
        s.value("thickness", l.thickness)
            .unit("m")
            .plausible(1e-4, 30)
            .positive()
            .required()
            .doc("thickness");
        s.check(
            [&l] {
              const auto known = foundation_materials();
              return std::find(known.begin(), known.end(), l.material) != known.end()
                         ? std::string()
                         : "'" + l.material + "' is not one of: " + base::join(known);
            },
            "material");
      },
      "layers from the tank downwards");
  section.value("cell", p.cell)
      .unit("m")
      .plausible(1e-3, 10)
      .positive()
      .doc("maximum height of a cell next to the tank");
  section.value("step", p.step).unit("s").plausible(0.1, 1e5).positive().doc("time step of the ground");
  section.value("deep-temperature", p.deep_temperature)
      .unit("K")
      .range(200, 600)
      .doc("temperature below the layers; absent: the air's annual mean");
  section.check([&p] { return p.layers.empty() ? "at least one layer is needed" : ""; }, "layers");
}

void declare(config::Section& section, UllageParameters& p) {
  section.value("gauge-pressure", p.gauge_pressure)
      .unit("Pa")
      .plausible(1, 1e6)
      .doc("gauge pressure of the gas");
  section.value("emissivity-liquid", p.emissivity_liquid)
      .range(0.01, 1)
      .doc("emissivity of the liquid's surface");
  section.value("emissivity-roof", p.emissivity_roof)
      .range(0.01, 1)
      .doc("emissivity of the roof's inner surface");
  section.value("emissivity-wall", p.emissivity_wall)
      .range(0.01, 1)
      .doc("emissivity of the wall above the liquid");
}

void declare(config::Section& section, TankParameters& p) {
  section.value("diameter", p.diameter)
      .unit("m")
      .plausible(0.01, 300)
      .positive()
      .required()
      .doc("inner diameter of the tank");
  section.value("exchange-step", p.exchange_step)
      .unit("s")
      .plausible(0.1, 1e5)
      .not_negative()
      .doc("maximum time between heat exchanges of the elements; 0: once per step of the simulation");
  section.section(
      "fluid", [&p](config::Section& s) { declare(s, p.fluid); }, "heat-transfer fluid");
  section.section(
      "filler", [&p](config::Section& s) { declare(s, p.filler); }, "grains of the bed; default: quartzite");
  section.section(
      "bed", [&p](config::Section& s) { declare(s, p.bed); }, "fluid and filler");
  section.optional_section<ShellParameters>(
      "shell", p.shell, [](config::Section& s, ShellParameters& v) { declare(s, v); }, "metal wall of rings");
  section.optional_section<FillerMechanicsParameters>(
      "filler-mechanics", p.mechanics, [](config::Section&, FillerMechanicsParameters&) {},
      "the filler follows the wall outwards and resists inwards, between Rankine's active and passive states");
  section.optional_section<ExternalWallParameters>(
      "external-wall", p.external_wall, [](config::Section& s, ExternalWallParameters& v) { declare(s, v); },
      "another program computes the wall's stress: it receives temperature and pressure and gives its "
      "displacement");
  section.optional_section<InsulationParameters>(
      "insulation", p.insulation, [](config::Section& s, InsulationParameters& v) { declare(s, v); },
      "blanket around the shell");
  section.optional_section<UllageSpace>(
      "ullage", p.ullage,
      [](config::Section& s, UllageSpace& v) {
        s.value("height", v.height)
            .unit("m")
            .plausible(0.01, 100)
            .positive()
            .required()
            .doc("between bed and roof");
        declare(s, v.gas);
      },
      "gas and radiation between the bed and the roof");
  section.optional_section<GroundParameters>(
      "ground", p.ground, [](config::Section& s, GroundParameters& v) { declare(s, v); },
      "foundation and soil under the tank");
  section.optional_section<ElsewhereParameters>(
      "elsewhere", p.elsewhere,
      [](config::Section& s, ElsewhereParameters& v) {
        s.value("ground", v.ground).doc("a participant with element: ground");
        s.value("insulation", v.insulation).doc("a participant with element: insulation");
      },
      "elements of this tank that other participants compute");
  section.optional_section<PumpParameters>(
      "pump", p.pump,
      [](config::Section& s, PumpParameters& v) {
        s.value("efficiency", v.efficiency).range(0.01, 1).doc("efficiency of pump or fan with its motor");
      },
      "pressure loss of the bed by Ergun's equation, and the required pump work");
  section.optional_section<Present>(
      "ambient", p.ambient_given, [&p](config::Section& s, Present&) { declare(s, p.ambient); },
      "weather; absent: still air of 20 degC, no sun");
  section.section(
      "flow", [&p](config::Section& s) { declare(s, p.flow); }, "flow through the tank");
  section.section(
      "output",
      [&p](config::Section& s) {
        s.value("monitor-interval", p.output.monitor_interval)
            .unit("s")
            .plausible(0.1, 1e7)
            .not_negative()
            .doc("time between rows of tank.csv; 0: each step");
      },
      "profiles are written at the output interval of the simulation");
  section.optional_section<ReportParameters>(
      "report", p.report, [](config::Section& s, ReportParameters& r) { declare(s, r); },
      "daily balance of plant and tank, and factors of safety; requires flow: {type: plant}");
  check_together(section, p);
}

}  // namespace couplet::thermocline
