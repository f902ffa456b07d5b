// SPDX-License-Identifier: Apache-2.0
#include "thermocline/wall/insulation.hpp"
#include "thermocline/wall/shell.hpp"
#include "thermocline/wall/ullage.hpp"

namespace couplet::thermocline {

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

}  // namespace couplet::thermocline
