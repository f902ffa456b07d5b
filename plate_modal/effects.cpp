// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "plate_modal/model/build_model.hpp"

namespace couplet::plate {
namespace {

using S = PlateScene;

std::string when(bool on, const char* reason) { return on ? reason : ""; }
bool is_dynamic(const S& s) { return s.parameters.analysis == Parameters::Analysis::dynamic; }
std::string dynamic_asked_by(const S& s) { return when(is_dynamic(s), "analysis: dynamic"); }

/// Shortest contact with a whole plate and the steps in it; modes from a file report it in a run.
std::string contact_asked_by(const S& s) {
  const Parameters& p = s.parameters;
  if (!p.contact) return "";
  if (!p.mesh || !(p.thickness > 0) || std::isnan(s.time_step)) return "contact";
  const double kappa = p.contact->stiffness.value_or(p.contact->scale * seat_stiffness(p));
  double mass = p.material.density * p.thickness;
  for (const auto& [name, zone] : p.zones)
    mass = std::min(mass, zone.density.value_or(p.material.density) * zone.thickness.value_or(p.thickness));
  const double shortest = std::numbers::pi * std::sqrt(mass / kappa);
  return fmt::format("contact: an impact lasts at least {:.2g} s, {:.2g} steps (recommended: 20)", shortest,
                     shortest / s.time_step);
}

/// Card of an effect that a run judges but does not include.
PlateCard left_out(const char* name, const char* key, const char* judged_by) {
  return {name, key, [](const S&) { return std::string(); }, {}, judged_by};
}

const std::array cards{
    PlateCard{"inertia", "`analysis: dynamic`", dynamic_asked_by, "rate and acceleration per mode",
              "of the static steps: acceleration over omega^2 and the deflection, rms over the modes"},
    PlateCard{"balance of the energies", "`analysis: dynamic`", dynamic_asked_by, "energies.csv",
              "in a dynamic analysis: error of the energy balance over the largest energy, 0.01", true},
    PlateCard{"step that resolves the contact", "`contact`",
              [](const S& s) { return when(s.parameters.contact.has_value(), "contact"); }, "",
              "with `contact`: a step over the duration of an impact, 0.1", true},
    left_out("large rotation", "no key: not in the model",
             "max displacement over the structure's size, or rigid rotation [rad]"),
    left_out(
        "motion in the plane", "no key: not in the model",
        "part in the plane over that across it, of gravity on a plate that may fall, or of the initial velocity"),
    left_out("deflection beyond the modes", "`modes.number`",
             "truncated modes: static, of the deflection, dynamic, of the compliance of the loads"),
    left_out("load faster than the modes", "`modes.number`",
             "frequency of an oscillating load over that of the highest retained mode"),
    left_out("initial velocity beyond the modes", "`modes.number`", "share of its energy outside the modes"),
    left_out("load that moves no mode", "no key: `load`, `modes.number`",
             "modal loads of the pressures over what they would be along the motion, 1e-9"),
    left_out("load within a face", "no key: finer mesh",
             "face center against sixteen points, of the load's effect on the modes, 0.05"),
    left_out("stretch of the mid-surface", "no key: not in the model",
             "of a plate with two or more held edges: deflection over thickness"),
    left_out("shear and rotary inertia", "no key: not in the model",
             "softening of the modes by their wavelength over the thickness, rms over the motion"),
    PlateCard{"damping", "`damping`",
              [](const S& s) { return when(s.parameters.damping.has_value(), "damping"); },
              "a coefficient per mode",
              "for information: share of the motion that 2 % of the critical damping would take"},
    PlateCard{"gravity", "`gravity`",
              [](const S& s) { return when(!s.parameters.gravity.empty(), "gravity"); }, "a load per mode",
              "for information: deflection by the weight across a held plate over that by the loads"},
    PlateCard{"contact with a seat", "`contact`", contact_asked_by,
              "mode shapes of the faces toward the seat, a full matrix of the modes; contact.csv"},
    PlateCard{"pressures of the case", "`load`",
              [](const S& s) { return when(s.parameters.load.has_value(), "load"); },
              "one expression per face and step"},
    PlateCard{"forces of a fluid", "`coupling`", [](const S& s) { return when(s.coupled, "coupling"); },
              "the mean of each mode over each face; the processes of the fluid and the coupler"},
    PlateCard{"modes of another program", "`modes.file`",
              [](const S& s) { return when(s.parameters.modes_file.has_value(), "modes.file"); },
              "no mesh, no eigenvalue problem"},
    PlateCard{"probes", "`probes`", [](const S& s) { return when(!s.parameters.probes.empty(), "probes"); },
              "probes.csv"},
    PlateCard{"moving surface", "`output.fields: true`",
              [](const S& s) { return when(s.parameters.output.fields, "output.fields"); },
              "fields at the outputs"},
    PlateCard{"shapes of the modes", "`output.modes: true`",
              [](const S& s) { return when(s.parameters.output.modes, "output.modes"); },
              "a series of fields at the start"},
};

}  // namespace

std::span<const PlateCard> plate_effect_cards() { return cards; }

}  // namespace couplet::plate
