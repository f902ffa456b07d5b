// SPDX-License-Identifier: Apache-2.0
#include "thermocline/bed/bed_parameters.hpp"

#include <algorithm>
#include <cmath>
#include <functional>

#include "common/base/error.hpp"
#include "thermocline/bed/grains.hpp"
#include "thermocline/bed/packed_bed.hpp"

namespace couplet::thermocline {
namespace {

void declare_closures(config::Section& s, ClosureParameters& p) {
  s.choice(
       "conduction", p.conduction,
       {{"stagnant", Conduction::stagnant}, {"wakao", Conduction::wakao}, {"constant", Conduction::constant}})
      .doc(
          "axial conduction. stagnant: that of the bed at rest (Zehner and Schluender; in a gas with radiation between the "
          "grains) + 0.5 Re Pr k. wakao: 0.7 eps k + 0.5 Re Pr k, that of the fluid alone, as in the thesis. constant: given "
          "by 'conductivity'");
  s.value("conductivity", p.conductivity)
      .unit("W/(m K)", 1e-3, 1e4)
      .not_negative()
      .doc("axial conductivity for 'conduction: constant'");
  as_film(s.value("film-coefficient", p.film_coefficient))
      .not_negative()
      .doc("heat transfer coefficient between fluid and grains; 0 means Nu = 2 + 1.1 Pr^(1/3) Re^0.6");
}

std::string problem_of_profile(const BedParameters& p) {
  if (p.profile_z.size() != p.profile_temperature.size()) return "needs as many values as profile-z";
  const bool grows = std::is_sorted(p.profile_z.begin(), p.profile_z.end(), std::less_equal<>());
  return grows ? "" : "profile-z must increase from value to value";
}

void declare_layer(config::Section& s, BedLayer& l) {
  as_length(s.value("height", l.height)).positive().required().doc("height");
  s.value("porosity", l.porosity).range(0.01, 1).required().doc("volume fraction of fluid; 1 without filler");
  s.value("diameter", l.diameter)
      .unit("m", 1e-4, 1)
      .positive()
      .required()
      .doc("effective diameter of the grains");
  declare_section(s, "filler", l.filler, "grains of this layer, if different from those of the tank");
  declare_section(s, "melting", l.melting,
                  "phase-change capsules with the density, specific heat and conductivity of 'filler'");
  s.check(
      [&l] {
        return l.melting && l.porosity >= 1
                   ? "a layer of fluid only (porosity 1) has no capsules that could melt"
                   : "";
      },
      "melting");
}

void declare_start(config::Section& section, BedParameters& p) {
  as_temperature(section.value("initial-temperature", p.initial_temperature))
      .positive()
      .doc("initial temperature of fluid and filler");
  section.value("profile-z", p.profile_z)
      .unit("m", 1e-4, 300)
      .doc("heights of an initial profile, instead of one temperature");
  as_temperature(section.value("profile-temperature", p.profile_temperature))
      .doc("temperatures of the profile, piecewise linear");
}

}  // namespace

BedGrid::BedGrid(const std::vector<BedLayer>& layers, int cells) {
  if (cells < int(layers.size()))
    throw Error("bed: {} cells are not enough for {} layers; each layer needs at least one.", cells,
                layers.size());
  for (const BedLayer& l : layers) height += l.height;
  // Layer boundaries at the nearest face of the uniform grid, with at least one cell per layer.
  std::vector<int> ends;
  double below = 0;
  const int n_layers = int(layers.size());
  for (int l = 0; l < n_layers; ++l) {
    below += layers[l].height;
    const int least = (ends.empty() ? 0 : ends.back()) + 1, most = cells - (n_layers - 1 - l);
    ends.push_back(l + 1 == n_layers ? cells
                                     : std::clamp(int(std::lround(below / height * cells)), least, most));
  }
  z.resize(cells), dz.resize(cells), layer.resize(cells);
  double bottom = 0;
  for (int l = 0, first = 0; l < n_layers; first = ends[l++]) {
    const int count = ends[l] - first;
    runs.push_back({first, count, layers[l]});
    for (int i = 0; i < count; ++i) {
      dz[first + i] = layers[l].height / count;
      z[first + i] = bottom + (i + 0.5) * dz[first + i];
      layer[first + i] = l;
    }
    bottom += layers[l].height;
  }
}

void declare(config::Section& section, BedParameters& p) {
  section.value("cells", p.cells)
      .range(1, 1e6)
      .doc("number of cells along z; layers begin and end at cell faces");
  section.list<BedLayer>(
      "layers", p.layers, [](config::Section& s, BedLayer& l) { declare_layer(s, l); }, "from the bottom up");
  section.value("shells", p.shells)
      .range(1, most_shells)
      .doc("number of shells of equal volume in a grain; 1 gives the linear driving force model");
  section
      .choice("advection", p.advection,
              {{"upwind", Advection::upwind}, {"tvd", Advection::tvd}, {"implicit", Advection::implicit}})
      .doc(
          "upwind: explicit, first order, as in the thesis. tvd: explicit, second order. implicit: upwind, any step");
  section.value("courant", p.courant)
      .range(1e-4, 0.95)
      .doc(
          "ratio of the time step of the bed to the time that the fluid takes to cross the cell with the least fluid; with tvd "
          "at most 0.5");
  section.value("conducting-inlet", p.conducting_inlet)
      .doc("true: heat is conducted through the face of the inlet as well");
  section.value("mix-inversions", p.mix_inversions)
      .doc("true: fluid that is colder than the fluid below it is mixed with that fluid");
  section.section(
      "closures", [&p](config::Section& s) { declare_closures(s, p.closures); }, "transfer coefficients");
  declare_start(section, p);
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

}  // namespace couplet::thermocline
