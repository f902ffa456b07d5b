// SPDX-License-Identifier: Apache-2.0
#include "thermocline/model/parameters.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "common/base/text.hpp"
#include "thermocline/model/model.hpp"

namespace couplet::thermocline {
namespace {

void check_together(config::Section& s, TankParameters& p) {
  const auto refuse = [&](const char* key, const char* why, auto&& is_wrong) {
    s.check([why, is_wrong] { return is_wrong() ? why : ""; }, key);
  };
  const auto is_plant = [&p] { return p.flow.type == FlowParameters::Type::plant; };
  refuse("filler-mechanics", "requires a shell; add one", [&p] { return p.mechanics && !p.shell; });
  refuse("external-wall", "requires shell and filler-mechanics",
         [&p] { return p.external_wall && !(p.shell && p.mechanics); });
  refuse("report", "requires a plant: set flow: {type: plant, ...} or remove it",
         [&p, is_plant] { return p.report && !is_plant(); });
  s.check(
      [&p, is_plant] {
        const double step = p.flow.plant.hot - p.flow.plant.cold;
        return p.report && is_plant() && step > 0 && p.report->thickness_margin >= 0.5 * step
                   ? fmt::format(
                         "thickness-margin is {:g} K, half of the difference between cold and hot ({:g} "
                         "K) or more: nothing is left between the two critical temperatures",
                         p.report->thickness_margin, step)
                   : "";
      },
      "report");
  refuse("elsewhere", "specifies that the ground is elsewhere; remove 'ground' here",
         [&p] { return p.elsewhere && p.elsewhere->ground && p.ground; });
  refuse("elsewhere", "specifies that the insulation is elsewhere; remove 'insulation' here",
         [&p] { return p.elsewhere && p.elsewhere->insulation && p.insulation; });
  refuse("elsewhere", "requires a shell inside the insulation",
         [&p] { return p.elsewhere && p.elsewhere->insulation && !p.insulation && !p.shell; });
  refuse("insulation", "requires a shell; add one", [&p] { return p.insulation && !p.shell; });
  refuse("bed", "a gas crosses a cell in milliseconds: set bed.advection: implicit", [&p] {
    const bool is_light = p.fluid.type == MediumInput::Type::custom && p.fluid.density < lightest_liquid;
    return (p.fluid.type == MediumInput::Type::air || is_light) && p.bed.advection != Advection::implicit;
  });
  s.check([&p] { return forgotten_unit_of_bed(p); }, "bed");
  s.check([&p] { return forgotten_unit_of_flow(p); }, "flow");
  s.check([&p] { return season_without_dates(p); }, "flow");
}

}  // namespace

void declare(config::Section& section, GroundParameters& p) {
  section.list<GroundLayer>(
      "layers", p.layers,
      [](config::Section& s, GroundLayer& l) {
        s.value("material", l.material).required().doc(base::join(foundation_materials()));
        as_thickness(s.value("thickness", l.thickness)).positive().required().doc("thickness");
        s.check(
            [&l] {
              const auto known = foundation_materials();
              return std::find(known.begin(), known.end(), l.material) != known.end()
                         ? std::string()
                         : "'" + l.material + "' is not one of: " + base::join(known);
            },
            "material");
      },
      "layers from the tank downwards, above soil at the annual mean temperature of the air");
  section.value("cell", p.cell)
      .unit("m", 1e-3, 10)
      .positive()
      .doc("maximum height of a cell next to the tank");
  as_step(section.value("step", p.step)).positive().doc("time step of the ground");
  section.check([&p] { return p.layers.empty() ? "at least one layer is needed" : ""; }, "layers");
}

namespace {

void declare_elements(config::Section& section, TankParameters& p) {
  declare_section(section, "fluid", p.fluid, "heat-transfer fluid");
  declare_section(section, "filler", p.filler, "grains of the bed; default: quartzite");
  declare_section(section, "bed", p.bed, "fluid and filler");
  declare_section(section, "shell", p.shell, "metal wall of rings");
  section.optional_section<Present>(
      "filler-mechanics", p.mechanics, [](config::Section&, Present&) {},
      "the filler follows the wall when it moves outward and resists it when it moves inward, between Rankine's active and "
      "passive states");
  declare_section(
      section, "external-wall", p.external_wall,
      "another program computes the wall's stress: it receives temperature and pressure and gives its displacement");
  declare_section(section, "insulation", p.insulation, "blanket around the shell");
  section.optional_section<UllageSpace>(
      "ullage", p.ullage,
      [](config::Section& s, UllageSpace& v) {
        as_length(s.value("height", v.height)).positive().required().doc("between bed and roof");
        s.value("gauge-pressure", v.gauge_pressure).unit("Pa", 1, 1e6).doc("gauge pressure of the gas");
      },
      "gas and radiation between the bed and the roof");
  declare_section(section, "ground", p.ground, "foundation and soil under the tank");
  section.optional_section<ElsewhereParameters>(
      "elsewhere", p.elsewhere,
      [](config::Section& s, ElsewhereParameters& v) {
        s.value("ground", v.ground).doc("a participant with element: ground");
        s.value("insulation", v.insulation).doc("a participant with element: insulation");
      },
      "elements of this tank that other participants compute");
}

}  // namespace

void declare(config::Section& section, TankParameters& p) {
  as_tank_length(section.value("diameter", p.diameter)).doc("inner diameter of the tank");
  as_step(section.value("exchange-step", p.exchange_step))
      .not_negative()
      .doc("maximum time between heat exchanges of the elements; 0 means once per step of the simulation");
  declare_elements(section, p);
  section.optional_section<PumpParameters>(
      "pump", p.pump,
      [](config::Section& s, PumpParameters& v) {
        s.value("efficiency", v.efficiency).range(0.01, 1).doc("efficiency of pump or fan with its motor");
      },
      "pressure loss of the bed by Ergun's equation, and the required pump work");
  section.optional_section<Present>(
      "ambient", p.ambient_given, [&p](config::Section& s, Present&) { declare(s, p.ambient); },
      "weather; default: still air of 20 degC, no sun");
  declare_section(section, "flow", p.flow, "flow through the tank");
  section.section(
      "output",
      [&p](config::Section& s) {
        s.value("monitor-interval", p.output.monitor_interval)
            .unit("s", 0.1, 1e7)
            .not_negative()
            .doc("time between rows of tank.csv; 0 means each step");
      },
      "profiles are written at the output interval of the simulation");
  declare_section(section, "report", p.report,
                  "daily balance of plant and tank, and factors of safety; requires flow: {type: plant}");
  check_together(section, p);
}

}  // namespace couplet::thermocline
