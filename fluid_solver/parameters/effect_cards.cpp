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
using V = std::optional<effects::EffectVerdict>;

std::string when(bool on, const char* reason) { return on ? reason : ""; }

template <class Test>
bool has_boundary(const S& s, const Test& test) {
  return std::ranges::any_of(s.parameters.boundaries, [&](const auto& b) { return test(b.second); });
}

bool has_interface(const S& s) {
  return has_boundary(s, [](const auto& b) { return condition_of(b).velocity == GivenBy::structure; });
}

// Layers are as thin as where they begin: where the mesh resolves those at the walls (y+ up to 1) it resolves what they shed,
// and the cell Reynolds number of the flow outside them says little.
V judge_turbulence(const S&, const E& e) {
  if (std::isnan(e.largest_peclet)) return {};
  const bool resolved_walls = e.largest_yplus > 0 && e.largest_yplus <= 1;
  const double limit = resolved_walls ? 250. : 50.;
  effects::EffectVerdict v{
      "", e.largest_peclet, limit,
      fmt::format("max cell Reynolds number = {:.3g}, max y+ = {:.3g}", e.largest_peclet, e.largest_yplus),
      "steep layers may be thinner than the mesh: refine it, or add 'turbulence' if the flow is turbulent"};
  // Layers get thinner with the root of the number: what a mesh that is too coarse by that misses of them.
  v.share = e.largest_peclet > limit ? 1 - std::sqrt(limit / e.largest_peclet) : 0;
  return v;
}

V judge_walls(const S&, const E& e) {
  if (std::isnan(e.largest_yplus)) return {};
  return effects::EffectVerdict{
      "", e.largest_yplus, 2,
      fmt::format("max y+ = {:.3g}, max cell Reynolds number = {:.3g}", e.largest_yplus, e.largest_peclet),
      "there is no wall function: refine at the walls to y+ of about 1"};
}

/// What the model adds to the viscosity decides what it does.
V spare_turbulence(const S&, const E& e) {
  if (std::isnan(e.eddy_viscosity)) return {};
  return effects::EffectVerdict{
      .effect = "",
      .number = e.eddy_viscosity,
      .threshold = 0.01,
      .sentence = fmt::format("max eddy viscosity = {:.2g} of the molecular", e.eddy_viscosity)};
}

std::optional<Sound> sound_in(const S& s) {
  return sound_of(s.parameters.compressibility, s.parameters.density, s.parameters.viscosity);
}

// Density changes go with the Mach number squared over two: 5 % at 0.3.
V judge_compressibility(const S& s, const E& e) {
  const auto sound = sound_in(s);
  if (!sound || std::isnan(e.largest_speed)) return {};
  const double mach = e.largest_speed / sound->speed;
  return effects::EffectVerdict{
      .effect = "",
      .number = mach,
      .threshold = 0.3,
      .sentence = fmt::format("max speed {:.3g} m/s = {:.2g} of the speed of sound in {} ({:.4g} m/s)",
                              e.largest_speed, mach, sound->of, sound->speed),
      .recommendation =
          "density would change by more than 5 %: use a compressible solver; if the speed of sound differs, "
          "set it in 'compressibility'",
      .share = mach < 0.9 ? 1 / std::sqrt(1 - mach * mach) - 1 : 1};  // of pressures [Prandtl and Glauert]
}

// Where flow is stopped or driven faster than waves cross the domain the pressure rises as rho c du or rho L
// du/dt, whatever the Mach number; the density follows by dp/(rho c^2). What the speed itself explains of that, 2 M^2 of a
// body in a stream (pressures from 1 to -3 of rho u^2/2), is the compressibility's share.
effects::EffectVerdict judge_density(const S& s, const E& e, const Sound& sound) {
  const double change = e.pressure_range / (s.parameters.density * sound.speed * sound.speed);
  return {.effect = "",
          .number = change,
          .threshold = 0.05,
          .sentence = fmt::format("pressure range {:.3g} Pa: density change of {} = {:.2g}", e.pressure_range,
                                  sound.of, change),
          .recommendation =
              s.parameters.is_compressible()
                  ? "'compressibility' holds for small changes of density only: use a compressible solver"
                  : "the flow changes faster than pressure waves would allow: add 'compressibility'",
          .share = std::max(0., change - 2 * std::pow(e.largest_speed / sound.speed, 2))};
}

// What the walls displace goes partly into compression, V dp / (rho c^2) = V dp / (gamma p) of a gas: of the volume of their
// stroke it is what an incompressible fluid pushes through the openings instead.
effects::EffectVerdict judge_compliance(const S& s, const E& e, const Sound& sound) {
  const double share =
      e.pressure_volume / (s.parameters.density * sound.speed * sound.speed) / std::max(e.stroke, 1e-300);
  return {
      .effect = "",
      .number = share,
      .threshold = 0.1,
      .sentence = fmt::format("compression of {} / volume displaced by the walls = {:.2g}", sound.of, share),
      .recommendation =
          "the compliance of the fluid may change frequencies and stability of the coupled motion: add "
          "'compressibility'",
      .cumulative = true,
      .share = share};
}

// A column of length L answers a motion of rate omega as tan(omega L/c) / (omega L/c): 3 % more than without waves at 0.3.
effects::EffectVerdict judge_wave_time(const S&, const E& e, const Sound& sound) {
  const double phase = e.wall_rate * e.size / sound.speed;
  return {.effect = "",
          .number = phase,
          .threshold = 0.3,
          .sentence =
              fmt::format("sound crosses {} in {:.2g} s = {:.2g} of 1/omega = {:.2g} s of the wall motion",
                          sound.of, e.size / sound.speed, phase, 1 / e.wall_rate),
          .recommendation = "pressure waves return while the walls move: add 'compressibility'",
          .cumulative = true,
          .share = phase < 1 ? std::tan(phase) / std::max(phase, 1e-300) - 1 : 1};
}

// Linear acoustics: what it leaves out goes with the change of density.
V judge_small_changes(const S& s, const E& e) {
  const auto sound = sound_in(s);
  if (!sound || std::isnan(e.pressure_range)) return {};
  return judge_density(s, e, *sound);
}

/// The worst of the three, by its limit.
V judge_waves(const S& s, const E& e) {
  const auto sound = sound_in(s);
  if (!sound) return {};
  V worst;
  const auto add = [&worst](effects::EffectVerdict v) {
    if (!worst || !(v.number / v.threshold <= worst->number / worst->threshold)) worst = std::move(v);
  };
  if (!std::isnan(e.pressure_range)) add(judge_density(s, e, *sound));
  // What an instant has shown is told then; the means below count at the end only.
  if (worst && !worst->sound()) return worst;
  if (!std::isnan(e.stroke)) {
    add(judge_compliance(s, e, *sound));
    add(judge_wave_time(s, e, *sound));
  }
  return worst;
}

// The guard ends a run that grows at once; what grows slowly is said.
V judge_energy(const S&, const E& e) {
  if (std::isnan(e.energy_excess)) return {};
  return effects::EffectVerdict{
      .effect = "",
      .number = e.energy_excess,
      .threshold = 0.1,
      .sentence = fmt::format("kinetic energy without work of boundaries or forces = {:.2g} of the total",
                              e.energy_excess),
      .recommendation = "the time scheme generates it: remove 'time-step' or reduce it",
      .wrong_from = 0.5};
}

V judge_still_mesh(const S& s, const E& e) {
  if (s.moving_mesh || std::isnan(e.wall_displacement)) return {};
  return effects::EffectVerdict{
      "", e.wall_displacement, 0.1,
      fmt::format("max interface displacement / adjacent cell height = {:.2g}", e.wall_displacement),
      "add a mesh mover: 'coupling: {mesh: {participant: ...}}'"};
}

// A wall that moves across itself on a mesh that rests is an inlet.
V judge_moving_walls(const S&, const E& e) {
  if (std::isnan(e.through_walls)) return {};
  return effects::EffectVerdict{
      "", e.through_walls, 0.1,
      fmt::format("a moving wall has a normal velocity of {:.2g} times its speed", e.through_walls),
      "its mesh is at rest, so fluid crosses the wall: use a tangential velocity, make it an inlet, or move "
      "it with 'motion'"};
}

V judge_blocked(const S&, const E& e) {
  if (std::isnan(e.blocked_cells)) return {};
  return effects::EffectVerdict{"", e.blocked_cells, 0.5,
                                fmt::format("blocked by gaps: {:.2g} of all cells", e.blocked_cells),
                                "is 'opening' in metres, and smaller than the channel?"};
}

const std::array cards{
    FluidCard{"turbulence model",
              "`turbulence`",
              [](const S& s) { return when(s.parameters.turbulence.has_value(), "turbulence"); },
              {"an eddy viscosity per cell, a velocity gradient per step", 62, 0.78},
              "max cell Reynolds number, 50, or 250 with resolved walls (y+ up to 1)",
              judge_turbulence,
              false,
              spare_turbulence},
    FluidCard{"resolved walls",
              "`turbulence`",
              [](const S& s) { return when(s.parameters.turbulence.has_value(), "turbulence"); },
              {},
              "with a turbulence model: max y+, 2",
              judge_walls,
              true},
    FluidCard{"balance of the kinetic energy",
              "always",
              [](const S&) { return std::string("always"); },
              {"a loop over the boundary", 0, 0},
              "kinetic energy without work, of the total, 0.1",
              judge_energy,
              true},
    FluidCard{"compressibility",
              "not available here",
              [](const S&) { return std::string(); },
              {},
              "max speed over the speed of sound (`compressibility`, or by density and viscosity), 0.3",
              judge_compressibility},
    FluidCard{
        "waves of pressure",
        "`compressibility`",
        [](const S& s) { return when(s.parameters.is_compressible(), "compressibility"); },
        {"three pressures per cell in the right side of the pressure equation, whose matrix changes with the step",
         0, 0},
        "density change by the pressure range, 0.05; for moving walls: compressed over displaced volume, "
        "0.1, and travel time of sound across the fluid over 1/omega of the wall motion, 0.3",
        judge_waves},
    FluidCard{"small changes of density",
              "`compressibility`",
              [](const S& s) { return when(s.parameters.is_compressible(), "compressibility"); },
              {},
              "with `compressibility`: density change by the pressure range, 0.05",
              judge_small_changes,
              true},
    FluidCard{
        "mesh motion",
        "a mesh mover in `coupling.mesh`, or `motion`",
        [](const S& s) { return when(s.moving_mesh, s.parameters.motion ? "motion" : "coupling.mesh"); },
        {"points, swept volumes, geometry of each step; without `motion` the process mesh_mover", 0, 0},
        "for an interface: max displacement over the cell height, 0.1",
        judge_still_mesh},
    FluidCard{"moving frame",
              "`motion` with only a `translation`",
              [](const S& s) {
                return when(s.parameters.motion && s.parameters.motion->translates(), "motion.translation");
              },
              {"nothing: geometry, pressure matrix and factors are computed once", 0, 0}},
    FluidCard{"rotating frame",
              "`rotating-frame`",
              [](const S& s) { return when(s.parameters.rotating_frame.has_value(), "rotating-frame"); },
              {"a force per cell", 0, 0}},
    FluidCard{"coupling load",
              "a boundary of `type: interface`",
              [](const S& s) { return when(s.coupled && has_interface(s), "a boundary of type interface"); },
              {"forces per interface face", 0, 0}},
    FluidCard{"implicit sub-steps bounded by accuracy",
              "`implicit-stretch`",
              [](const S& s) { return when(s.parameters.implicit_stretch.has_value(), "implicit-stretch"); },
              {"up to as many more sub-steps as the stability limit exceeds this bound", 0, 0}},
    FluidCard{
        "walls that yield (Robin interface)",
        "`surface-density` or `impedance` of a boundary of type interface",
        [](const S& s) {
          return when(
              std::ranges::any_of(s.parameters.boundaries, [](const auto& b) { return b.second.foresees(); }),
              "surface-density");
        },
        {"two loops over the interface per pass, a pressure per face in the coupling; a new pressure matrix "
         "where the step is halved",
         0, 0}},
    FluidCard{"pressure level of a closed fluid",
              "`volume-level: structure`",
              [](const S& s) {
                return when(s.parameters.volume_level == VolumeLevelBy::structure, "volume-level: structure");
              },
              {"one or two more structure steps per pass, an inflow per interface face", 0, 0}},
    FluidCard{"immersed bodies",
              "`bodies`",
              [](const S& s) { return when(!s.parameters.bodies.empty(), "bodies"); },
              {"a flag per cell and face", 350, 0.58}},
    FluidCard{"gaps that close",
              "`gaps`",
              [](const S& s) { return when(!s.parameters.gaps.empty(), "gaps"); },
              {"a flag per cell; the distance of the two walls where they are close", 40, 0},
              "share of the cells that they block, 0.5",
              judge_blocked,
              true},
    FluidCard{"walls that move along themselves",
              "`type: moving-wall`",
              [](const S& s) {
                for (const auto& [name, b] : s.parameters.boundaries)
                  if (is_moving_wall(b)) return "boundaries." + name;
                return std::string();
              },
              {},
              "on a mesh at rest: flow through them over speed times area, 0.1",
              judge_moving_walls,
              true},
    FluidCard{"body force",
              "`body-force`",
              [](const S& s) { return when(!s.parameters.body_force.empty(), "body-force"); },
              {"a force per cell", 30, 0.05}},
    FluidCard{"third dimension", "`dimension: 3`",
              [](const S& s) { return when(s.parameters.dimension == 3, "dimension: 3"); }},
    FluidCard{"running statistics",
              "`statistics`",
              [](const S& s) { return when(s.parameters.statistics.has_value(), "statistics"); },
              {"sums of velocity, pressure and their squares per cell", 56, 0.04}},
    FluidCard{"lines and planes",
              "`output.samples`",
              [](const S& s) { return when(!s.parameters.output.samples.empty(), "output.samples"); },
              {"interpolation at their points and files at the outputs", 0, 0}},
    FluidCard{"velocity from a file",
              "`table` of an inlet or moving wall",
              [](const S& s) {
                return when(has_boundary(s, [](const auto& b) { return b.table.has_value(); }), "table");
              },
              {"the table; a look-up per face of the patch", 0, 0}},
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
