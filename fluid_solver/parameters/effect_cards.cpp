// SPDX-License-Identifier: Apache-2.0
#include "fluid_solver/parameters/effect_cards.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace couplet::fluid {
namespace {

using S = FluidScene;
using E = FluidEvidence;
using V = std::optional<EffectVerdict>;

std::string when(bool on, const char* reason) { return on ? reason : ""; }

template <class Test>
bool has_boundary(const S& s, const Test& test) {
  return std::ranges::any_of(s.parameters.boundaries, [&](const auto& b) { return test(b.second); });
}

bool has_interface(const S& s) {
  return has_boundary(s, [](const auto& b) { return b.type == BoundaryType::interface; });
}

// Layers are as thin as where they begin: where the mesh resolves those at the walls (y+ up to 1) it resolves what they shed,
// and the cell Reynolds number of the flow outside them says little.
V judge_turbulence(const S&, const E& e) {
  if (std::isnan(e.largest_peclet)) return {};
  const bool resolved_walls = e.largest_yplus > 0 && e.largest_yplus <= 1;
  return EffectVerdict{
      "", e.largest_peclet, resolved_walls ? 250. : 50.,
      fmt::format("the largest cell Reynolds number is {:.3g}, the largest y+ {:.3g}", e.largest_peclet,
                  e.largest_yplus),
      "steep layers may be finer than the mesh: refine it, or give 'turbulence' if the flow is turbulent"};
}

V judge_walls(const S&, const E& e) {
  if (std::isnan(e.largest_yplus)) return {};
  return EffectVerdict{"", e.largest_yplus, 2,
                       fmt::format("the largest y+ is {:.3g}, the largest cell Reynolds number {:.3g}",
                                   e.largest_yplus, e.largest_peclet),
                       "there is no wall function: y+ should be about 1, refine at the walls"};
}

std::optional<Sound> sound_in(const S& s) {
  return sound_of(s.parameters.compressibility, s.parameters.density, s.parameters.viscosity);
}

// Density changes go with the Mach number squared over two: 5 % at 0.3.
V judge_compressibility(const S& s, const E& e) {
  const auto sound = sound_in(s);
  if (!sound || std::isnan(e.largest_speed)) return {};
  const double mach = e.largest_speed / sound->speed;
  return EffectVerdict{
      .effect = "",
      .number = mach,
      .threshold = 0.3,
      .sentence = fmt::format("the largest speed, {:.3g} m/s, is {:.2g} of that of sound in {} ({:.4g} m/s)",
                              e.largest_speed, mach, sound->of, sound->speed),
      .recommendation =
          "density would change by more than 5 %, which this program does not know; is the speed of sound "
          "another, give it in 'compressibility'"};
}

// Where flow is stopped or driven faster than waves cross the domain the pressure rises as rho c du or rho L
// du/dt, whatever the Mach number; the density follows by dp/(rho c^2).
EffectVerdict judge_density(const S& s, const E& e, const Sound& sound) {
  const double change = e.pressure_range / (s.parameters.density * sound.speed * sound.speed);
  return {.effect = "",
          .number = change,
          .threshold = 0.05,
          .sentence = fmt::format("pressures {:.3g} Pa apart would change the density of {} by {:.2g} of it",
                                  e.pressure_range, sound.of, change),
          .recommendation =
              "flow changes faster here than waves of pressure would let it; this program knows no waves"};
}

// What the walls displace goes partly into compression, V dp / (rho c^2) = V dp / (gamma p) of a gas: of the volume of their
// stroke it is what an incompressible fluid pushes through the openings instead.
EffectVerdict judge_compliance(const S& s, const E& e, const Sound& sound) {
  const double share =
      e.pressure_volume / (s.parameters.density * sound.speed * sound.speed) / std::max(e.stroke, 1e-300);
  return {
      .effect = "",
      .number = share,
      .threshold = 0.1,
      .sentence =
          fmt::format("compression of {} takes up {:.2g} of the volume that the walls move", sound.of, share),
      .recommendation =
          "the fluid yields like a spring beside the structure, which this program does not know: frequencies and "
          "stability of the coupled motion may be others"};
}

// A column of length L answers a motion of rate omega as tan(omega L/c) / (omega L/c): 3 % more than without waves at 0.3.
EffectVerdict judge_wave_time(const S&, const E& e, const Sound& sound) {
  const double phase = e.wall_rate * e.size / sound.speed;
  return {
      .effect = "",
      .number = phase,
      .threshold = 0.3,
      .sentence = fmt::format(
          "sound in {} crosses the fluid in {:.2g} s, {:.2g} of the time 1/omega = {:.2g} s in which "
          "the walls move",
          sound.of, e.size / sound.speed, phase, 1 / e.wall_rate),
      .recommendation = "waves of pressure come back while the walls move, which this program does not know"};
}

/// The worst of the three, by its limit.
V judge_waves(const S& s, const E& e) {
  const auto sound = sound_in(s);
  if (!sound) return {};
  V worst;
  const auto add = [&worst](EffectVerdict v) {
    if (!worst || !(v.number / v.threshold <= worst->number / worst->threshold)) worst = std::move(v);
  };
  if (!std::isnan(e.pressure_range)) add(judge_density(s, e, *sound));
  if (!std::isnan(e.stroke)) {
    add(judge_compliance(s, e, *sound));
    add(judge_wave_time(s, e, *sound));
  }
  return worst;
}

// The guard ends a run that grows at once; what grows slowly is said.
V judge_energy(const S&, const E& e) {
  if (std::isnan(e.energy_excess)) return {};
  return EffectVerdict{
      .effect = "",
      .number = e.energy_excess,
      .threshold = 0.1,
      .sentence = fmt::format(
          "the flow has {:.2g} of its kinetic energy from no work of boundaries and forces", e.energy_excess),
      .recommendation = "the time scheme makes it: leave 'time-step' out or make it smaller",
      .wrong_from = 0.5};
}

V judge_still_mesh(const S& s, const E& e) {
  if (s.moving_mesh || std::isnan(e.wall_displacement)) return {};
  return EffectVerdict{"", e.wall_displacement, 0.1,
                       fmt::format("the interface moves by up to {:.2g} of the height of the cell beside it",
                                   e.wall_displacement),
                       "give the case a mesh mover: 'coupling: {mesh: {participant: ...}}'"};
}

// A wall that moves across itself on a mesh that rests is an inlet.
V judge_moving_walls(const S&, const E& e) {
  if (std::isnan(e.through_walls)) return {};
  return EffectVerdict{
      "", e.through_walls, 0.1,
      fmt::format("of the speed of a moving wall {:.2g} goes through the wall", e.through_walls),
      "its mesh rests, so that fluid comes in or leaves there: let the wall move along itself, "
      "call it an inlet, or move it with 'motion'"};
}

V judge_blocked(const S&, const E& e) {
  if (std::isnan(e.blocked_cells)) return {};
  return EffectVerdict{"", e.blocked_cells, 0.5,
                       fmt::format("gaps block {:.2g} of all cells", e.blocked_cells),
                       "is the 'opening' given in metres, and smaller than the channel?"};
}

const std::array cards{
    FluidCard{"turbulence model",
              "`turbulence`",
              [](const S& s) { return when(s.parameters.turbulence.has_value(), "turbulence"); },
              {"an eddy viscosity a cell, a velocity gradient a step", 62, 0.78},
              "largest cell Reynolds number, 50, or 250 where walls are resolved (y+ up to 1)",
              judge_turbulence},
    FluidCard{"resolved walls",
              "`turbulence`",
              [](const S& s) { return when(s.parameters.turbulence.has_value(), "turbulence"); },
              {},
              "with a turbulence model: largest y+, 2",
              judge_walls,
              true},
    FluidCard{"balance of the kinetic energy",
              "always",
              [](const S&) { return std::string("always"); },
              {"a loop over the boundary", 0, 0},
              "kinetic energy that no work explains, over all, 0.1",
              judge_energy,
              true},
    FluidCard{"compressibility",
              "not available here",
              [](const S&) { return std::string(); },
              {},
              "largest speed over that of sound (`compressibility`, or by density and viscosity), 0.3",
              judge_compressibility},
    FluidCard{
        "waves of pressure",
        "not available here",
        [](const S&) { return std::string(); },
        {},
        "density change by the range of pressure, 0.05; of moving walls: volume taken up by compression over that of "
        "their stroke, 0.1, and time of sound across the fluid over 1/omega of their motion, 0.3",
        judge_waves},
    FluidCard{
        "mesh motion",
        "a mesh mover in `coupling.mesh`, or `motion`",
        [](const S& s) { return when(s.moving_mesh, s.parameters.motion ? "motion" : "coupling.mesh"); },
        {"points, swept volumes, geometry of each step; without `motion` the process mesh_mover", 0, 0},
        "of an interface: largest displacement over the cell's height, 0.1",
        judge_still_mesh},
    FluidCard{"frame that moves",
              "`motion` with a `translation` alone",
              [](const S& s) {
                return when(s.parameters.motion && s.parameters.motion->translates(), "motion.translation");
              },
              {"nothing: geometry, pressure matrix and factors are made once", 0, 0}},
    FluidCard{"frame that turns",
              "`rotating-frame`",
              [](const S& s) { return when(s.parameters.rotating_frame.has_value(), "rotating-frame"); },
              {"a force a cell", 0, 0}},
    FluidCard{"coupling load",
              "a boundary of `type: interface`",
              [](const S& s) { return when(s.coupled && has_interface(s), "a boundary of type interface"); },
              {"forces a face of the interface", 0, 0}},
    FluidCard{"implicit sub-steps bounded by accuracy",
              "`implicit-stretch`",
              [](const S& s) { return when(s.parameters.implicit_stretch.has_value(), "implicit-stretch"); },
              {"up to as many more sub-steps as stability would let them be longer", 0, 0}},
    FluidCard{
        "walls that yield (Robin interface)",
        "`surface-density` or `impedance` of a boundary of type interface",
        [](const S& s) {
          return when(
              std::ranges::any_of(s.parameters.boundaries, [](const auto& b) { return b.second.foresees(); }),
              "surface-density");
        },
        {"two loops over the interface a pass, a pressure a face over the coupling; pressure matrix anew where the "
         "step is cut",
         0, 0}},
    FluidCard{"pressure level of a closed fluid",
              "`volume-level: structure`",
              [](const S& s) {
                return when(s.parameters.volume_level == VolumeLevelBy::structure, "volume-level: structure");
              },
              {"the structure's step once or twice more a pass, an inflow a face of the interface", 0, 0}},
    FluidCard{"immersed bodies",
              "`bodies`",
              [](const S& s) { return when(!s.parameters.bodies.empty(), "bodies"); },
              {"a mark a cell and face", 350, 0.58}},
    FluidCard{"gaps that close",
              "`gaps`",
              [](const S& s) { return when(!s.parameters.gaps.empty(), "gaps"); },
              {"a mark a cell; the distance of two walls where they are near each other", 40, 0},
              "share of the cells that they block, 0.5",
              judge_blocked,
              true},
    FluidCard{"walls that move along themselves",
              "`type: moving-wall`",
              [](const S& s) {
                for (const auto& [name, b] : s.parameters.boundaries)
                  if (b.type == BoundaryType::moving_wall) return "boundaries." + name;
                return std::string();
              },
              {},
              "on a mesh at rest: flow through them over their speed and area, 0.1",
              judge_moving_walls,
              true},
    FluidCard{"body force",
              "`body-force`",
              [](const S& s) { return when(!s.parameters.body_force.empty(), "body-force"); },
              {"a force a cell", 30, 0.05}},
    FluidCard{"third dimension", "`dimension: 3`",
              [](const S& s) { return when(s.parameters.dimension == 3, "dimension: 3"); }},
    FluidCard{"running statistics",
              "`statistics`",
              [](const S& s) { return when(s.parameters.statistics.has_value(), "statistics"); },
              {"sums of velocity, pressure and their squares a cell", 56, 0.04}},
    FluidCard{"lines and planes",
              "`output.samples`",
              [](const S& s) { return when(!s.parameters.output.samples.empty(), "output.samples"); },
              {"interpolation at their places and files at the outputs", 0, 0}},
    FluidCard{"velocity from a file",
              "`table` of an inlet or moving wall",
              [](const S& s) {
                return when(has_boundary(s, [](const auto& b) { return b.table.has_value(); }), "table");
              },
              {"the table; a look-up a face of the patch", 0, 0}},
    FluidCard{"rotating inlet or wall",
              "`rotation` of an inlet or moving wall",
              [](const S& s) {
                return when(has_boundary(s, [](const auto& b) { return b.rotation.has_value(); }),
                            "rotation");
              },
              {}},
    FluidCard{"vorticity and Q",
              "`output.vorticity`, `output.q-criterion`",
              [](const S& s) {
                return when(s.parameters.output.vorticity || s.parameters.output.q_criterion, "output");
              },
              {"fields at the outputs", 0, 0}},
    FluidCard{"energy budget",
              "`output.energy-budget`",
              [](const S& s) { return when(s.parameters.output.energy_budget, "output.energy-budget"); },
              {"energy.csv, work of the step summed over the faces", 15, 0.06}},
};

}  // namespace

std::span<const FluidCard> fluid_effect_cards() { return cards; }

}  // namespace couplet::fluid
