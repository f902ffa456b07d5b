// SPDX-License-Identifier: Apache-2.0
// Findings of all programs. Each program must know all ids, because a case accepts findings for the whole job.
#include <array>
#include <stdexcept>
#include <string>

#include "common/base/text.hpp"
#include "common/diagnostics/finding.hpp"

namespace couplet::diagnostics {
namespace {

constexpr auto answer = FindingId::About::answer, neglected = FindingId::About::neglected;

// clang-format off
constexpr std::array ids{
    // common
    FindingId{answer, "error-estimate", "the estimated error exceeds 15 % of the solution"},
    FindingId{answer, "questionable-key", "a value of the case is far outside the usual range"},
    FindingId{answer, "questionable-mesh-scale", "the extent of the mesh is implausible, probably because of a wrong `mesh-scale`"},
    FindingId{answer, "given-without-effect", "a load, inlet, source, body, motion, table, schedule row or filler of the case never had an effect, or a load excites no mode"},
    FindingId{answer, "unseen-between-steps", "an expression of time changes by more than half of its largest value between two steps, so the time steps do not resolve it"},
    FindingId{answer, "distorted-mesh", "a cell of the deformed mesh is folded at a corner"},
    FindingId{answer, "table-left", "a material table was evaluated outside its range"},
    FindingId{answer, "atmosphere-on-one-side", "the fluid load is a uniform pressure of about one atmosphere that acts on only one side of a structure"},
    FindingId{answer, "changed-since-checkpoint", "a resumed run continues with a case that was changed since the checkpoint"},
    FindingId{neglected, "inertia", "the loads of a static run change so fast that inertia matters", {"solid_solver plate_modal", "analysis: dynamic", "ratio of inertia to load in the static steps"}},
    FindingId{neglected, "gravity", "the weight is not negligible compared with the loads", {"solid_solver plate_modal", "gravity", "ratio of the work of the weight to that of the loads (for a plate, ratio of the deflections); for information"}},
    FindingId{neglected, "damping", "damping would reduce the motion noticeably", {"solid_solver plate_modal", "damping", "reduction of the motion by a damping ratio of 2 %; for information"}},
    // coupler
    FindingId{answer, "iteration-of-pressure-and-structure", "a coupling with one iteration per step is near its added-mass stability limit"},
    FindingId{answer, "interface-oscillation", "the motion of the interface alternates from step to step with growing amplitude"},
    FindingId{answer, "interface-work", "over the whole run, the work done by one side of the interface differs from the work received by the other side"},
    FindingId{answer, "questionable-displacement", "a participant gives a displacement that is inconsistent with its velocity or far larger than its interface; its unit is probably wrong"},
    FindingId{answer, "structure-at-rest", "a loaded structure has not moved for ten steps"},
    FindingId{answer, "unconverged-step", "a step of an iterated coupling was accepted before it had converged"},
    FindingId{neglected, "viscous-coupling-load", "some of the fluid's forces are not passed to any structure", {"coupler", "", "ratio of the fluid forces that no structure receives to those that one receives"}},
    FindingId{answer, "noise-of-the-coupling", "the residual of the coupling iteration causes a noticeable error in the acceleration of the interface"},
    FindingId{answer, "surfaces-apart", "interfaces that should coincide differ in size or position"},
    // fluid_solver
    FindingId{answer, "flow-through-openings", "fluid leaves through an inlet or enters through an outlet (where 'pressure' is then the total pressure), or a uniform pressure over the height of an opening drives a flow"},
    FindingId{answer, "given-step", "the prescribed time step is far above the stability limit of this mesh"},
    FindingId{answer, "resolved-walls", "a turbulence model is used, but the mesh does not resolve the flow at the walls"},
    FindingId{answer, "eddy-viscosity-in-two-dimensions", "a turbulence model is used in two dimensions or on a mesh one cell deep, where it only adds viscosity"},
    FindingId{answer, "viscosity-law", "a viscosity law whose viscosity hardly varies, so that a number would do"},
    FindingId{answer, "frozen-flow", "the flow was still changing when it was frozen for the computation of the temperature alone"},
    FindingId{answer, "ringing-pressure", "pressure waves that the time steps do not resolve oscillate undamped, because the trapezoidal rule does not damp them"},
    FindingId{answer, "small-changes-of-density", "the density of a weakly compressible fluid changes too much for the model"},
    FindingId{neglected, "turbulence-model", "the mesh does not resolve the shear layers at this Reynolds number", {"fluid_solver", "turbulence", "largest Reynolds number of the shear within a cell; limit 50, or 250 if the walls are resolved (y+ up to 1). A flow whose Reynolds number with the hydraulic diameter is below 3450 counts as laminar"}},
    FindingId{neglected, "compressibility", "the Mach number of the fluid, or of the gas between the grains of a bed, is high", {"fluid_solver thermocline", "", "ratio of the largest speed to the speed of sound"}},
    FindingId{neglected, "waves-of-pressure", "pressure waves or the compressibility of the fluid affect the result", {"fluid_solver", "compressibility", "relative change of the density due to the pressure range; with moving walls also the ratio of the compressed to the displaced volume, and the travel time of sound multiplied by the angular frequency omega of the walls"}},
    FindingId{neglected, "mesh-motion", "an interface moves, but the fluid mesh is at rest", {"fluid_solver", "motion or coupling.mesh", "ratio of the largest interface displacement to the height of the adjacent cell"}},
    // plate_modal
    FindingId{answer, "step-that-resolves-the-contact", "an impact lasts less than ten time steps"},
    FindingId{answer, "deflection-beyond-the-modes", "the loads or the initial velocity excite truncated modes, or the loads oscillate faster than the highest mode"},
    FindingId{answer, "load-within-a-face", "the load varies strongly within a face"},
    FindingId{neglected, "large-rotation", "the rotations are too large for linear modes", {"plate_modal", "", "ratio of the largest displacement to the size of the structure; for a free body the rigid-body rotation [rad]"}},
    FindingId{neglected, "motion-in-the-plane", "loads or motions in the plane of the plate are neglected", {"plate_modal", "", "ratio of the in-plane to the normal component of the initial velocity, or of gravity on a free plate"}},
    FindingId{neglected, "stretch-of-the-mid-surface", "the deflection is so large that it stretches the mid-surface", {"plate_modal", "", "ratio of the deflection to the thickness, for a plate held on opposite sides"}},
    FindingId{neglected, "shear-and-rotary-inertia", "the wavelengths of some modes are too short for thin-plate theory", {"plate_modal", "", "reduction of the modal stiffness by shear and rotary inertia, estimated from thickness and wavelength (rms over the motion)"}},
    // solid_solver
    FindingId{answer, "stress-error", "the estimated error of the stress at a probe or of the largest equivalent stress, with a warning if it is large"},
    FindingId{answer, "quantity-error", "the value of a quantity of interest and its estimated error"},
    FindingId{answer, "strain-energy", "the work of the loads and the strain energy disagree, or the strains vary too much within quadrilaterals"},
    FindingId{answer, "energy-growth", "the motion or flow gained energy that nothing supplied, or the energies of the modes do not balance"},
    FindingId{answer, "heat-swing", "the temperature oscillates from step to step"},
    FindingId{answer, "impossible-temperature", "a temperature is below absolute zero"},
    FindingId{answer, "buckling", "the loads of a linear static run are near or above the buckling loads"},
    FindingId{answer, "unstable-equilibrium", "the computed equilibrium is unstable"},
    FindingId{answer, "limit-load", "an arc-length run passed a limit point (a maximum or minimum of the load)"},
    FindingId{neglected, "geometric-non-linearity", "the displacement gradients of a linear run are large", {"solid_solver", "kinematics: finite-strain", "estimated change of the displacement; where this is not estimated, a displacement gradient of 0.02 or more is a warning"}},
    FindingId{neglected, "contact", "parts of the body pass through each other", {"solid_solver", "contact", "ratio of the penetration depth to the largest displacement"}},
    FindingId{neglected, "yielding", "the stress of a body or of a tank's wall exceeds the yield strength", {"solid_solver thermocline", "", "ratio of the equivalent stress to `yield-strength`; without this key, a stress above 0.01 of Young's modulus of a metal is a warning (above 0.002 it is noted)"}},
    FindingId{neglected, "near-incompressibility", "Poisson's ratio is near 0.5, but the volume strain is not constant per cell", {"solid_solver", "solution-method.volume-strain: cells", "largest Poisson's ratio; limit 0.45"}},
    FindingId{neglected, "thermal-strain", "the temperature would cause thermal strain", {"solid_solver", "thermal-expansion", "ratio of the free thermal strain to the displacement gradient; without an `expansion` for information"}},
    FindingId{neglected, "storage-of-heat", "the thermal conditions change too fast for a steady temperature", {"solid_solver", "heat.analysis: transient", "ratio of the heat diffusion time to the time in which the steady temperature changes"}},
    FindingId{neglected, "thermoelastic-coupling", "thermoelastic coupling would noticeably stiffen the body", {"solid_solver", "thermoelastic-coupling: true", "relative stiffening due to thermoelastic coupling"}},
    // thermocline
    FindingId{answer, "questionable-plant", "the weather, calendar or prices of the plant are questionable"},
    FindingId{answer, "tank-state", "a material or closure of the tank was used outside its range of validity"},
    FindingId{answer, "day-report", "the daily report has no valid basis, for example because too few days were counted"},
    FindingId{neglected, "mixing-of-inverted-fluid", "cold fluid lies above hot fluid and would sink", {"thermocline", "bed.mix-inversions: true", "ratio of the largest inversion to the temperature range of the run"}},
    FindingId{neglected, "resolved-grains", "the temperature varies within the grains", {"thermocline", "bed.shells above 1", "delay by conduction within the grains relative to the passage time of a front, and Biot number"}},
    FindingId{neglected, "range-of-the-film-correlation", "the Reynolds number is outside the range of the film correlation, and the film matters", {"thermocline", "bed.closures.film-coefficient above 0", "width of the front due to the film resistance where Re is out of range, relative to the bed height"}},
    FindingId{neglected, "conduction-through-the-grains", "axial conduction through the grains is neglected", {"thermocline", "bed.closures.conduction: stagnant", "width that it adds to a front, over the bed"}},
    FindingId{neglected, "radiation-between-the-grains", "radiation between the grains of a gas bed is neglected", {"thermocline", "filler.emissivity above 0", "width that it adds to a front, relative to the bed height (gas only)"}},
    FindingId{neglected, "pressure-loss-of-the-bed", "the bed's pressure loss consumes a noticeable part of the heat", {"thermocline", "pump", "ratio of the pump or fan power to the heat transported by the largest flow"}},
    FindingId{neglected, "bending-of-the-wall", "bending adds to the stress of the wall", {"thermocline", "external-wall", "contribution of bending to the largest equivalent stress, relative to the stress computed with rings"}},
    FindingId{neglected, "specific-heat-of-a-gas-by-its-temperature", "the specific heat varies with temperature", {"thermocline", "", "relative difference between the mean specific heat over the temperature range of the run and the constant specific heat of the model"}},
};
// clang-format on

}  // namespace

std::span<const FindingId> finding_ids() { return ids; }

const FindingId& finding_id(const std::string& id) {
  for (const FindingId& known : ids)
    if (id == known.id) return known;
  throw std::logic_error("common/diagnostics/ids.cpp has no finding '" + id + "'");
}

std::string unknown_ids(std::span<const std::string> ids) {
  std::vector<std::string> known;
  for (const FindingId& f : finding_ids()) known.push_back(f.id);
  std::string text;
  for (const std::string& id : ids) {
    if (std::ranges::count(known, id) > 0) continue;
    const auto meant = base::closest(id, known);
    text += fmt::format("{}unknown finding '{}'{}", text.empty() ? "" : "; ", id,
                        meant ? fmt::format(", did you mean '{}'?", *meant) : "");
  }
  return text.empty() ? text : fmt::format("{}. Findings: {}", text, base::join(known));
}

}  // namespace couplet::diagnostics
