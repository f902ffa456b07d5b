// SPDX-License-Identifier: Apache-2.0
#include "plate_modal/effect_judgements.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace couplet::plate {
namespace {

using S = PlateScene;
using E = PlateEvidence;
using V = std::optional<effects::EffectVerdict>;

bool is_dynamic_scene(const S& s) { return s.parameters.analysis == Parameters::Analysis::dynamic; }

}  // namespace

// A clamped strip whose tip has moved by a quarter of its length has turned there by about 20 degrees: the
// foreshortening that modes do not know is 0.6 x 0.25^2 of the length, 4 %.
V judge_rotation(const S&, const E& e) {
  // A rigid body that turns by 0.25 rad is stretched by 1 / cos, 3 %.
  if (!std::isnan(e.rotation))
    return effects::verdict(e.rotation, 0.25, fmt::format("rigid rotation = {:.2g} rad", e.rotation),
                            "linear modes move a body along its tangent: use a program for finite strain",
                            1 / std::max(0.1, std::cos(e.rotation)) - 1);
  return effects::verdict(
      e.displacement_over_size, 0.25,
      fmt::format("max displacement / structure size = {:.2g}", e.displacement_over_size),
      "modes are linear and cannot describe large rotations: use a program for finite strain",
      0.6 * e.displacement_over_size * e.displacement_over_size);
}

V judge_in_plane(const S& s, const E& e) {
  return effects::verdict(
      e.in_plane_share, 0.01,
      fmt::format(
          "in-plane share of {1} = {0:.2g}", e.in_plane_share,
          s.parameters.gravity.empty() ? "the initial velocity" : "the gravity or the initial velocity"),
      "no mode moves along the plane, so that part is neglected: apply only its normal part, or use a volume "
      "model",
      e.in_plane_share);
}

V judge_kept(const S& s, const E& e) {
  if (is_dynamic_scene(s))
    return effects::verdict(e.modes_apart, 0.05,
                            fmt::format("compliance of the loads in truncated modes = {:.2g}", e.modes_apart),
                            "the loads excite truncated modes: keep more modes ('modes.number')",
                            e.modes_apart);
  return effects::verdict(
      e.modes_apart, 0.05, fmt::format("truncation error of the deflection = {:.2g}", e.modes_apart),
      "fields and probes show the full deflection, but modal.csv and the interface only the modes: keep "
      "more modes ('modes.number')",
      e.modes_apart);
}

// A mode answers a load of frequency f as 1 / (1 - (f / f_mode)^2): at two thirds of its own frequency with 1.8 times
// what the static measure counts, and near it without limit.
V judge_load_beyond(const S&, const E& e) {
  return effects::verdict(
      e.step.load_over_last, 2. / 3,
      fmt::format("load frequency {:.3g} Hz = {:.2g} of the highest retained mode's",
                  e.step.load_omega / (2 * std::numbers::pi), e.step.load_over_last),
      "truncated modes may resonate: keep modes up to 1.5 times that frequency ('modes.number')");
}

V judge_velocity(const S&, const E& e) {
  return effects::verdict(
      e.velocity_lost, 0.1, fmt::format("initial kinetic energy outside the modes = {:.2g}", e.velocity_lost),
      "a uniform velocity near supports needs many modes: keep more, or use 'initial-amplitudes'",
      0.5 * e.velocity_lost);  // of an energy
}

V judge_within(const S&, const E& e) {
  return effects::verdict(
      e.within_faces, 0.05,
      fmt::format("error of the load's effect on the modes with one force per face = {:.2g}", e.within_faces),
      "the pressure varies within a face: refine the mesh there", e.within_faces);
}

// Cells of h in half a wave of n cells: (pi / n)^2 / 12 a direction; 0.1 is four cells in both.
V judge_mesh(const S&, const E& e) {
  return effects::verdict(
      e.mesh_gap, 0.1,
      fmt::format("deflection of cell centres against their corners = {:.2g} (rms over the motion)",
                  e.mesh_gap),
      "the mesh does not resolve the moving modes: use at least four cells per half wave in each direction");
}

// A plate that is held all round is stiffened by its stretch as 1 + 0.5 (w/h)^2, more or less by its edges.
V judge_stretch(const S&, const E& e) {
  const double stiffening = 0.5 * e.displacement_over_thickness * e.displacement_over_thickness;
  return effects::verdict(
      e.displacement_over_thickness, e.stretch_limit,
      fmt::format("held on opposite sides: max deflection / thickness = {:.2g}",
                  e.displacement_over_thickness),
      "unless its edges may slide in its plane, stretching stiffens it noticeably: use a program for finite "
      "strain",
      stiffening / (1 + stiffening));
}

// A force at the middle of each face does not see what lies between them.
V judge_lost(const S&, const E& e) {
  if (!e.load_lost) return {};
  return effects::EffectVerdict{
      "", 1, 0.5, "the prescribed pressures were 0 at every face centre in every step",
      "a load smaller than a face or shorter than a step is lost: refine, or distribute it over a face or a "
      "step with the same resultant"};
}

// Rounding alone: the modes do not move along the forces, or these cancel.
V judge_no_part(const S&, const E& e) {
  if (!(e.load_on_modes < 1e-9)) return {};
  return effects::EffectVerdict{
      "", 1, 0.5,
      fmt::format("modal load of the prescribed pressures = {:.1g} of what it would be along the motion",
                  e.load_on_modes),
      "nothing moves by them: with 'modes.file' the upper side is where the surface faces +z, whatever the "
      "structure's own normal; equal pressures on both sides cancel; a mode of another symmetry needs "
      "'modes.number'"};
}

// Mindlin's plate against Kirchhoff's: rotary inertia and shear lower omega^2 by (k h)^2 (1/12 + 1/(5 (1 - nu)))
// of it, omega by 2 % where half a wave, pi / k, is ten thicknesses long.
V judge_shear(const S& s, const E& e) {
  return effects::verdict(
      e.thickness_over_wave, 0.1,
      fmt::format("thickness / half the wavelength of the highest mode {1} = {0:.2g}", e.thickness_over_wave,
                  is_dynamic_scene(s) ? "with 1 % of the motion" : "kept"),
      "shear and rotary inertia soften such modes: keep fewer, or use a volume model",
      4 * e.thickness_over_wave * e.thickness_over_wave);  // twice the 2 % of omega at 0.1, in the motion
}

// Ten steps a period make the trapezoidal rule's 3 % too long, and a mode that swings at another frequency than its
// own answers a load as another structure would.
V judge_step(const S&, const E& e) {
  const StepEvidence& step = e.step;
  if (!(step.coarse_share > 0))
    return effects::verdict(step.coarse_share, 0.1, "no oscillating mode has fewer than ten steps per period",
                            "");
  return effects::verdict(
      step.coarse_share, 0.1,
      fmt::format("modes with fewer than ten steps per period (first: mode {}, {:.2g} steps) make up {:.2g} "
                  "of the displacement (rms)",
                  step.coarse_mode, step.steps_a_period, step.coarse_share),
      fmt::format("they oscillate at a wrong frequency: use 'simulation.time-step: {:.2g} s'",
                  step.recommended_step));
}

V judge_resonance(const S&, const E& e) {
  const StepEvidence& step = e.step;
  return effects::verdict(
      step.resonance_error, 0.1,
      fmt::format("mode {} is near resonance (amplification {:.2g}): displacement error by the step's "
                  "frequency error = {:.2g}",
                  step.resonant_mode, step.amplification, step.resonance_error),
      fmt::format("use 'simulation.time-step: {:.2g} s'", step.resonant_step));
}

V judge_load(const S&, const E& e) {
  return effects::verdict(
      e.step.load_apart, 0.1,
      fmt::format("load at mid-step against its mean over the step: difference {:.2g} of the load (rms)",
                  e.step.load_apart),
      "the step does not resolve the load: use ten or more steps per load period");
}

// A body on a seat: the time of an impact is wrong by a third of a step and its speed after it by as much of the
// impact; twenty steps a contact are 1 % (docs/plate.md).
V judge_contact(const S&, const E& e) {
  return effects::verdict(
      e.step.contact_share, 0.1,
      fmt::format("an impact on the seat lasts {:.2g} s (pi sqrt(m / kappa)), one step is {:.2g} of that",
                  e.step.contact_time, e.step.contact_share),
      fmt::format("the rebound is not resolved: use 'simulation.time-step: {:.2g} s', or a softer seat",
                  e.step.contact_time / 20));
}

V judge_energy(const S&, const E& e) {
  V v = effects::verdict(
      e.energy_mismatch, 0.01,
      fmt::format("max error of the energy balance (4.29-4.31) / largest energy = {:.2g}", e.energy_mismatch),
      "use a smaller step, or 'trapezoidal' with 'contact.rule: conserving'");
  if (v) v->wrong_from = 0.5;
  return v;
}

}  // namespace couplet::plate
