// SPDX-License-Identifier: Apache-2.0
// Keys of heat in the fluid.
#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "fluid_solver/parameters/parameters.hpp"

namespace couplet::fluid {

namespace {

/// The key of heat that a patch has.
const char* given_key(const BoundaryParameters& b) {
  return b.film ? "film" : b.heat_flux ? "heat-flux" : b.conjugate ? "conjugate" : "temperature";
}

}  // namespace

void declare_heat_boundary(config::Section& s, BoundaryParameters& b) {
  s.value("temperature", b.temperature)
      .unit("K", 70, 5000)
      .doc(
          "with `heat`: temperature of the patch, of x, y, z [m] and t [s]; at an outlet that of fluid which enters there. "
          "Absent: no heat is conducted through the patch; fluid that enters through an inlet has the initial temperature, "
          "and through an outlet that of the cell");
  s.value("heat-flux", b.heat_flux)
      .unit("W/m^2", 1e-6, 1e11)
      .doc("with `heat`, instead of 'temperature': heat flux into the fluid, of x, y, z [m] and t [s]");
  s.optional_section<FilmParameters>(
      "film", b.film,
      [](config::Section& f, FilmParameters& film) {
        f.value("coefficient", film.coefficient)
            .range(0, std::numeric_limits<double>::infinity())
            .unit("W/(m^2 K)", 1e-3, 1e7)
            .required()
            .doc("heat transfer coefficient, of x, y, z [m] and t [s]");
        f.value("ambient", film.ambient)
            .unit("K", 70, 5000)
            .required()
            .doc("temperature beyond the film, of x, y, z [m] and t [s]");
      },
      "with `heat`, instead of 'temperature': a film or a thin wall between the patch and its surroundings");
  s.value("conjugate", b.conjugate)
      .doc(
          "with `heat`, instead of 'temperature': heat passes to the participant of the coupling that meets the fluid here "
          "(conjugate heat transfer)");
  s.check(
      [&b] {
        const int given =
            b.temperature.has_value() + b.heat_flux.has_value() + b.film.has_value() + b.conjugate;
        if (given > 1) return "give one of 'temperature', 'heat-flux', 'film' and 'conjugate'";
        if (given == 1 && condition_of(b).joined)
          return "no heat is exchanged at periodic patches; remove 'temperature', 'heat-flux', 'film' or 'conjugate'";
        if ((b.heat_flux || b.film || b.conjugate) && condition_of(b).passage != Passage::none)
          return "fluid passes this patch, which may have a 'temperature' only; remove 'heat-flux', 'film' or 'conjugate'";
        return "";
      },
      given_key(b));
}

namespace {

void declare(config::Section& s, HeatParameters& h) {
  using Convection = HeatParameters::Convection;
  s.value("conductivity", h.conductivity)
      .unit("W/(m K)", 1e-3, 1e4)
      .positive()
      .required()
      .doc("thermal conductivity");
  s.value("specific-heat", h.specific_heat)
      .unit("J/(kg K)", 10, 1e5)
      .positive()
      .required()
      .doc("specific heat");
  s.value("initial-temperature", h.initial_temperature)
      .unit("K", 70, 5000)
      .doc(
          "initial temperature, of x, y, z; also of fluid that enters through inlets without a 'temperature'");
  s.value("gravity", h.gravity)
      .unit("m/s^2", 1e-3, 2000)
      .doc(
          "acceleration of gravity, one number per component, for buoyancy after Boussinesq: the force per mass is "
          "-expansion (T - reference-temperature) gravity, and the weight at the reference temperature is left out of the "
          "pressure. Default: no buoyancy");
  s.value("expansion", h.expansion)
      .unit("1/K", 1e-8, 1e-2)
      .doc("coefficient of thermal expansion by volume, for buoyancy");
  s.value("reference-temperature", h.reference_temperature)
      .unit("K", 70, 5000)
      .doc("temperature without buoyancy; the stored heat is counted from here");
  s.choice("convection", h.convection, {{"central", Convection::central}, {"bounded", Convection::bounded}})
      .doc(
          "central: as for the velocity. bounded: limited such that convection makes no new extremes, for fronts that the "
          "mesh does not resolve");
  s.value("frozen-flow", h.frozen_flow)
      .unit("s", 1e-10, 1e11)
      .not_negative()
      .doc(
          "time from which the flow stays as it is and only the temperature is computed, with steps of any size; for heat that "
          "spreads much more slowly than the flow settles. Default: never");
  s.check(
      [&h] {
        if (h.frozen_flow && !h.gravity.empty())
          return "buoyancy changes the flow with the temperature; remove one of the two";
        return h.frozen_flow && h.convection == Convection::bounded
                   ? "it carries the temperature with central values; remove 'convection'"
                   : "";
      },
      "frozen-flow");
  s.check([&h] { return h.gravity.empty() || h.expansion != 0 ? "" : "buoyancy needs 'expansion'"; },
          "gravity");
  s.check([&h] { return h.expansion == 0 || !h.gravity.empty() ? "" : "it has no effect without 'gravity'"; },
          "expansion");
}

}  // namespace

void declare_heat(config::Section& s, FluidParameters& p) {
  s.optional_section<HeatParameters>(
      "heat", p.heat, [](config::Section& h, HeatParameters& v) { declare(h, v); },
      "temperature of the fluid: conduction, transport by the flow, buoyancy; patches without 'temperature', 'heat-flux', "
      "'film' or 'conjugate' are insulated; default: not computed");
  const struct {
    bool applies;
    const char* message;
  } refused[] = {
      {p.is_compressible(),
       "not supported together with pressure waves; remove 'compressibility', or set 'scheme: none'"},
      {!p.bodies.empty(), "not supported together with immersed bodies; remove 'bodies'"},
      {p.heat && p.heat->frozen_flow &&
           (p.motion || std::ranges::any_of(p.boundaries,
                                            [](const auto& b) {
                                              return b.second.type == BoundaryType::interface ||
                                                     b.second.type == BoundaryType::body;
                                            })),
       "walls that move the fluid keep it flowing; remove 'frozen-flow'"},
      {!p.gaps.empty(), "not supported together with gaps that close; remove 'gaps'"},
      {p.turbulence.has_value(), "the heat of eddies is not modeled; remove 'turbulence'"},
      {p.courant && p.heat && p.heat->convection == HeatParameters::Convection::bounded,
       "bounded convection is explicit; remove 'courant', or 'convection' here"}};
  for (const auto& [applies, message] : refused)
    s.check([told = p.heat && applies ? message : ""] { return told; }, "heat");
  s.check(
      [&p] {
        const bool fits = !p.heat || p.heat->gravity.empty() || std::ssize(p.heat->gravity) == p.dimension;
        return fits ? "" : "one number per component is needed";
      },
      "heat.gravity");
  s.check(
      [told = !p.heat && p.viscosity_law && p.viscosity_law->by_temperature] {
        return told ? "this fluid has no temperature; add the section 'heat', or remove the key" : "";
      },
      "viscosity.by-temperature");
  const auto is_moved = [](const BoundaryParameters& b) { return b.type == BoundaryType::interface; };
  const bool conjugate = std::ranges::any_of(p.boundaries, [](const auto& b) { return b.second.conjugate; });
  const bool moved = std::ranges::any_of(p.boundaries, [&](const auto& b) { return is_moved(b.second); });
  for (const auto& [patch, b] : p.boundaries) {
    const char* problem =
        !p.heat && b.exchanges_heat() ? "this fluid has no 'heat'; add the section, or remove the key"
        : conjugate && moved && is_moved(b) != b.conjugate
            ? "all patches of a fluid where it meets other participants exchange the same data; give all "
              "those of 'type: interface' the key 'conjugate: true', and no others"
            : "";
    s.check([problem] { return problem; }, "boundaries." + patch + "." + given_key(b));
  }
}

}  // namespace couplet::fluid
