// SPDX-License-Identifier: Apache-2.0
#include "plate_modal/effect_cards.hpp"

#include <fmt/format.h>

#include <array>
#include <cmath>

namespace couplet::plate {
namespace {

using S = PlateScene;
using E = PlateEvidence;
using V = std::optional<EffectVerdict>;

std::string when(bool on, const char* reason) { return on ? reason : ""; }
bool is_dynamic(const S& s) { return s.parameters.analysis == Parameters::Analysis::dynamic; }

V verdict(double number, double threshold, std::string sentence, std::string recommendation) {
  if (std::isnan(number)) return {};
  return EffectVerdict{"", number, threshold, std::move(sentence), std::move(recommendation)};
}

// A clamped strip whose tip has moved by a quarter of its length has turned there by about 20 degrees: the
// foreshortening that modes do not know is 0.6 x 0.25^2 of the length, 4 %.
V judge_rotation(const S&, const E& e) {
  return verdict(
      e.displacement_over_size, 0.25,
      fmt::format("the largest displacement is {:.2g} of the structure's size", e.displacement_over_size),
      "modes are linear and know no large rotation: take a program for finite strain");
}

// A plate that is held all round is stiffened by its stretch as 1 + 0.5 (w/h)^2, more or less by its edges.
V judge_stretch(const S&, const E& e) {
  return verdict(e.displacement_over_thickness, 0.5,
                 fmt::format("the plate is held all round and deflects by {:.2g} of its thickness",
                             e.displacement_over_thickness),
                 "its stretch would stiffen it noticeably: take a program for finite strain");
}

// Mindlin's plate against Kirchhoff's: rotary inertia and shear lower omega^2 by (k h)^2 (1/12 + 1/(5 (1 - nu)))
// of it, omega by 2 % where half a wave, pi / k, is ten thicknesses long.
V judge_shear(const S&, const E& e) {
  return verdict(e.thickness_over_wave, 0.1,
                 fmt::format("half a wave of the highest mode kept is {:.3g} thicknesses long",
                             1 / std::max(e.thickness_over_wave, 1e-300)),
                 "such modes are softened by shear and rotary inertia: keep fewer, or take a volume");
}

V judge_energy(const S&, const E& e) {
  return verdict(
      e.energy_mismatch, 0.01,
      fmt::format("the balance of the energies (4.29-4.31) is off by up to {:.2g} of the largest energy",
                  e.energy_mismatch),
      "take a smaller step, or 'trapezoidal' with 'contact.rule: conserving'");
}

const std::array cards{
    PlateCard{"inertia",
              "`analysis: dynamic`",
              [](const S& s) { return when(is_dynamic(s), "analysis: dynamic"); },
              {"rate and acceleration a mode", 0, 0}},
    PlateCard{"balance of the energies",
              "`analysis: dynamic`",
              [](const S& s) { return when(is_dynamic(s), "analysis: dynamic"); },
              {"energies.csv", 0, 0},
              "mismatch over the largest energy, 0.01",
              judge_energy,
              true},
    PlateCard{"large rotation",
              "not available here",
              [](const S&) { return std::string(); },
              {},
              "largest displacement over the structure's size, 0.25",
              judge_rotation},
    PlateCard{"stretch of the mid-surface",
              "not available here",
              [](const S&) { return std::string(); },
              {},
              "of a plate held all round: deflection over thickness, 0.5",
              judge_stretch},
    PlateCard{"shear and rotary inertia",
              "not available here",
              [](const S&) { return std::string(); },
              {},
              "thickness over half the wave of the highest mode kept, 0.1",
              judge_shear},
    PlateCard{"damping",
              "`damping`",
              [](const S& s) { return when(s.parameters.damping.has_value(), "damping"); },
              {"a coefficient a mode", 0, 0}},
    PlateCard{"gravity",
              "`gravity`",
              [](const S& s) { return when(!s.parameters.gravity.empty(), "gravity"); },
              {"a load a mode", 0, 0}},
    PlateCard{
        "contact with a seat",
        "`contact`",
        [](const S& s) { return when(s.parameters.contact.has_value(), "contact"); },
        {"the shapes of the faces that look at the seat, a full matrix of the modes; contact.csv", 0, 0}},
    PlateCard{"pressures of the case",
              "`load`",
              [](const S& s) { return when(s.parameters.load.has_value(), "load"); },
              {"an expression a face and step", 0, 0}},
    PlateCard{"forces of a fluid",
              "`coupling`",
              [](const S& s) { return when(s.coupled, "coupling"); },
              {"the mean of each mode over each face; the processes of the fluid and the coupler", 0, 0}},
    PlateCard{"impedance for a Robin interface", "`surface-density: true`",
              [](const S& s) { return when(s.parameters.surface_density, "surface-density"); }},
    PlateCard{"modes of another program",
              "`modes.file`",
              [](const S& s) { return when(s.parameters.modes_file.has_value(), "modes.file"); },
              {"no mesh, no eigenvalues", 0, 0}},
    PlateCard{"probes",
              "`probes`",
              [](const S& s) { return when(!s.parameters.probes.empty(), "probes"); },
              {"probes.csv", 0, 0}},
    PlateCard{"moving surface",
              "`output.fields: true`",
              [](const S& s) { return when(s.parameters.output.fields, "output.fields"); },
              {"fields at the outputs", 0, 0}},
    PlateCard{"shapes of the modes",
              "`output.modes: true`",
              [](const S& s) { return when(s.parameters.output.modes, "output.modes"); },
              {"a series of fields at the start", 0, 0}},
};

}  // namespace

std::span<const PlateCard> plate_effect_cards() { return cards; }

}  // namespace couplet::plate
