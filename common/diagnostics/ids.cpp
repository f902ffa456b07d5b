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
    FindingId{answer, "error-estimate", "the estimated error is more than 0.15 of the solution"},
    FindingId{answer, "questionable-key", "a value of the case is far outside the usual range"},
    FindingId{answer, "questionable-mesh-scale", "the size of the mesh does not fit the case"},
    FindingId{answer, "given-without-effect", "a load, inlet, source, body, motion, table, row of a schedule or filler of the case never acted, or a load moves no mode"},
    FindingId{answer, "unseen-between-steps", "an expression of time varies by more than half of its largest value between two steps, so that the steps miss it"},
    FindingId{answer, "distorted-mesh", "a cell of the moved mesh is folded at a corner"},
    FindingId{answer, "table-left", "a table of a material was read outside its range"},
    FindingId{answer, "atmosphere-on-one-side", "the load of a fluid is a uniform pressure, about that of the atmosphere, on one side of a structure only"},
    FindingId{answer, "changed-since-checkpoint", "a resumed run continues with another case"},
    FindingId{neglected, "inertia", "a static run under a load that inertia would resist", {"solid_solver plate_modal", "analysis: dynamic", "inertia over load of the static steps"}},
    FindingId{neglected, "gravity", "the weight matters compared with the loads", {"solid_solver plate_modal", "gravity", "work of the weight over that of the loads; for a plate, its deflection; for information"}},
    FindingId{neglected, "damping", "damping would reduce the motion", {"solid_solver plate_modal", "damping", "reduction of the motion by 2 % of critical damping, for information"}},
    // coupler
    FindingId{answer, "iteration-of-pressure-and-structure", "one coupling iteration per step is near its added-mass limit"},
    FindingId{answer, "interface-oscillation", "the interface oscillates from step to step with growing amplitude"},
    FindingId{answer, "interface-work", "over the whole run, the work that one side gives differs from the work that the other side takes"},
    FindingId{answer, "questionable-displacement", "a participant gives a displacement that does not fit its velocity, or is far larger than its interface; its unit is probably wrong"},
    FindingId{answer, "structure-at-rest", "a loaded structure has not moved for ten steps"},
    FindingId{answer, "unconverged-step", "a step of an iterated coupling was accepted before it had converged"},
    FindingId{neglected, "viscous-coupling-load", "no structure takes the forces that the fluid gives", {"coupler", "", "forces of the fluid that no structure takes"}},
    FindingId{answer, "noise-of-the-coupling", "the residuals of the coupling iteration are not small compared with the acceleration of the interface"},
    FindingId{answer, "surfaces-apart", "surfaces that move together differ in size or position"},
    // fluid_solver
    FindingId{answer, "flow-through-openings", "fluid leaves through an inlet, or enters through an outlet: at total pressure, or driven by its weight where an opening has one pressure over its height"},
    FindingId{answer, "given-step", "a prescribed time step far beyond what is stable on this mesh"},
    FindingId{answer, "resolved-walls", "a turbulence model on walls that the mesh does not resolve"},
    FindingId{answer, "eddy-viscosity-in-two-dimensions", "a turbulence model in two dimensions or on a mesh one cell deep, where it only adds viscosity"},
    FindingId{answer, "viscosity-law", "a viscosity law whose viscosity hardly varies, so that a number would do"},
    FindingId{answer, "ringing-pressure", "waves that the steps do not resolve oscillate undamped in the trapezoidal rule"},
    FindingId{answer, "small-changes-of-density", "a weakly compressible fluid changes its density too much"},
    FindingId{neglected, "turbulence-model", "the mesh does not resolve layers of this Reynolds number", {"fluid_solver", "turbulence", "max Reynolds number of the shear within a cell, 50, or 250 with resolved walls (y+ up to 1); a flow below 3450 by the hydraulic diameter is laminar"}},
    FindingId{neglected, "compressibility", "the Mach number of a fluid, or of the gas between grains, is high", {"fluid_solver thermocline", "", "max speed over the speed of sound"}},
    FindingId{neglected, "waves-of-pressure", "pressure waves or the fluid's compliance matter", {"fluid_solver", "compressibility", "density change by the pressure range; of moving walls, compressed over displaced volume, and travel time of sound over 1/omega"}},
    FindingId{neglected, "mesh-motion", "an interface moves, but the mesh does not", {"fluid_solver", "motion or coupling.mesh", "max displacement of an interface over the cell height"}},
    // plate_modal
    FindingId{answer, "step-that-resolves-the-contact", "an impact is shorter than ten steps"},
    FindingId{answer, "deflection-beyond-the-modes", "the loads or the initial velocity excite truncated modes, or oscillate faster than the highest mode"},
    FindingId{answer, "load-within-a-face", "the load varies within a face"},
    FindingId{neglected, "large-rotation", "rotations too large for linear modes", {"plate_modal", "", "max displacement over the structure's size, or rigid rotation [rad]"}},
    FindingId{neglected, "motion-in-the-plane", "loads in the plane of the plate", {"plate_modal", "", "part in the plane over that across it, of gravity on a plate that may fall, or of the initial velocity"}},
    FindingId{neglected, "stretch-of-the-mid-surface", "deflection that stretches the mid-surface", {"plate_modal", "", "deflection over thickness of a plate with two or more held edges"}},
    FindingId{neglected, "shear-and-rotary-inertia", "modes with wavelengths too short for a thin plate", {"plate_modal", "", "softening of the modes by their wavelength over the thickness, rms over the motion"}},
    // solid_solver
    FindingId{answer, "stress-error", "estimated error of the stress at a probe, and of the largest equivalent stress"},
    FindingId{answer, "quantity-error", "estimated error of a quantity of interest"},
    FindingId{answer, "strain-energy", "work and strain energy disagree, or the strains vary too much within quadrilaterals"},
    FindingId{answer, "energy-growth", "the motion or flow has energy that nothing supplied, or the energies of the modes do not balance"},
    FindingId{answer, "heat-swing", "the temperature oscillates from step to step"},
    FindingId{answer, "impossible-temperature", "a temperature below absolute zero"},
    FindingId{answer, "buckling", "the loads of a linear static run are near or above the buckling loads"},
    FindingId{answer, "unstable-equilibrium", "the computed equilibrium is unstable"},
    FindingId{answer, "limit-load", "a run by arc length passed a maximum or minimum of the load"},
    FindingId{neglected, "geometric-non-linearity", "large displacement gradients in a linear run", {"solid_solver", "kinematics: finite-strain", "estimated change of the displacement; unknown where that is not estimated, with a warning from a displacement gradient of 0.02"}},
    FindingId{neglected, "contact", "faces of the body pass through each other", {"solid_solver", "contact", "depth of faces in other cells over the motion"}},
    FindingId{neglected, "yielding", "the stress of a body or of a tank's wall exceeds the yield strength", {"solid_solver thermocline", "", "equivalent stress over `yield-strength`; unknown without one, from 0.01 of Young's modulus of a metal (for information from 0.002)"}},
    FindingId{neglected, "near-incompressibility", "Poisson's ratio near 0.5 without one volume strain per cell", {"solid_solver", "solution-method.volume-strain: cells", "largest Poisson's ratio, 0.45"}},
    FindingId{neglected, "thermal-strain", "temperatures that would strain the body", {"solid_solver", "thermal-expansion", "strain of a free body over the displacement gradient; for information without an `expansion`"}},
    FindingId{neglected, "storage-of-heat", "a steady temperature under loads that change too fast for it", {"solid_solver", "heat.analysis: transient", "time in which heat spreads over that in which a steady temperature changes"}},
    FindingId{neglected, "thermoelastic-coupling", "heat of deformation would stiffen the body", {"solid_solver", "thermoelastic-coupling: true", "stiffening by heat of deformation"}},
    // thermocline
    FindingId{answer, "questionable-plant", "weather, calendar or prices of the plant are questionable"},
    FindingId{answer, "tank-state", "the tank has left the validity range of its closures"},
    FindingId{answer, "day-report", "the report has no valid basis"},
    FindingId{neglected, "mixing-of-inverted-fluid", "cold fluid above hot that would sink", {"thermocline", "bed.mix-inversions: true", "largest inversion over the run's range of temperatures"}},
    FindingId{neglected, "resolved-grains", "grains with a temperature gradient inside", {"thermocline", "bed.shells above 1", "delay within the grains over the passage of a front, and Biot number"}},
    FindingId{neglected, "range-of-the-film-correlation", "the Reynolds number is outside the range of the film correlation, and the film matters", {"thermocline", "bed.closures.film-coefficient above 0", "where Re is outside: width of the front that the film makes, over the bed"}},
    FindingId{neglected, "conduction-through-the-grains", "a bed whose grains do not conduct along it", {"thermocline", "bed.closures.conduction: stagnant", "width that it adds to a front, over the bed"}},
    FindingId{neglected, "radiation-between-the-grains", "a gas bed whose grains do not radiate", {"thermocline", "filler.emissivity above 0", "width that it adds to a front, over the bed, in a gas"}},
    FindingId{neglected, "pressure-loss-of-the-bed", "the bed's pressure loss consumes a noticeable part of the heat", {"thermocline", "pump", "power of a pump or fan over the heat transported by the largest flow"}},
    FindingId{neglected, "bending-of-the-wall", "bending adds to the wall's stress", {"thermocline", "external-wall", "contribution of bending to the largest equivalent stress, over the stress of rings"}},
    FindingId{neglected, "specific-heat-of-a-gas-by-its-temperature", "the specific heat varies", {"thermocline", "", "mean specific heat over the run's temperature range against the constant"}},
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
