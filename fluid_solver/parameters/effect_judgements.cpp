// SPDX-License-Identifier: Apache-2.0
#include "fluid_solver/parameters/effect_judgements.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace couplet::fluid {
namespace {

using S = FluidScene;
using E = FluidEvidence;
using V = std::optional<effects::EffectVerdict>;

// Ducts turn turbulent at 2300 by the mean speed; the largest of a plane laminar one is 3/2 of it.
constexpr double laminar_below = 3450;

std::optional<Sound> sound_in(const S& s) {
  return sound_of(s.parameters.compressibility, s.parameters.density, s.parameters.viscosity);
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

}  // namespace

// Layers are as thin as where they begin: where the mesh resolves those at the walls (y+ up to 1) it resolves what they shed,
// and the cell Reynolds number of the flow outside them says little. On whatever mesh, what passes walls so closely that ducts stay
// laminar there has no turbulence to model: what such a mesh misses is in its estimated error.
V judge_turbulence(const S& s, const E& e) {
  if (std::isnan(e.largest_peclet)) return {};
  const bool resolved_walls = e.largest_yplus > 0 && e.largest_yplus <= 1;
  const double limit = resolved_walls ? 250. : 50.;
  effects::EffectVerdict v{
      "", e.largest_peclet, limit,
      fmt::format("max cell Reynolds number = {:.3g}, max y+ = {:.3g}", e.largest_peclet, e.largest_yplus),
      s.parameters.dimension == 2
          ? "steep layers may be thinner than the mesh: refine it; if the flow is turbulent, use 'turbulence' "
            "and 'dimension: 3'"
          : "steep layers may be thinner than the mesh: refine it, or add 'turbulence' if the flow is "
            "turbulent"};
  const double reynolds = s.parameters.density * e.largest_speed * e.width / s.parameters.viscosity;
  if (e.largest_peclet > limit && reynolds < laminar_below) {
    v.number = reynolds, v.threshold = laminar_below;
    v.sentence = fmt::format("Reynolds number (max speed, hydraulic diameter) = {:.3g}: laminar; {}",
                             reynolds, v.sentence);
    return v;
  }
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
  effects::EffectVerdict v{
      .effect = "",
      .number = e.eddy_viscosity,
      .threshold = 0.01,
      .sentence = fmt::format("max eddy viscosity = {:.2g} of the molecular", e.eddy_viscosity)};
  v.saves = effects::saved_share("fluid_solver", "turbulence model");
  return v;
}

// Turbulence passes its energy to ever smaller eddies as vortices stretch, which those of two dimensions do not: there the models
// are added friction only, and layers thicken with the root of the viscosity.
V judge_flat_eddies(const S& s, const E& e) {
  if (std::isnan(e.eddy_viscosity)) return {};
  V spare = spare_turbulence(s, e);
  if (spare->could_be_omitted()) return spare;
  spare->saves = 0;
  spare->recommendation =
      "vortices in two dimensions do not stretch, so it models no turbulence: omit 'turbulence', or use 'dimension: 3'";
  spare->share = 1 - 1 / std::sqrt(1 + e.eddy_viscosity);
  return spare;
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

}  // namespace couplet::fluid
