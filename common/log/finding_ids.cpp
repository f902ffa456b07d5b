// SPDX-License-Identifier: Apache-2.0
#include <array>

#include "common/diagnostics/finding.hpp"

namespace couplet::log {
namespace {

constexpr auto answer = FindingId::About::answer, neglected = FindingId::About::neglected;

// Of an effect's card: its name in lower case with hyphens. docs/findings.md lists them all (tests/architecture).
constexpr std::array ids{
    // all programs
    FindingId{answer, "error-estimate", "the estimated error is more than 0.15 of the solution"},
    FindingId{answer, "questionable-key", "a value of the case is far outside the usual range"},
    FindingId{answer, "questionable-mesh-scale", "the size of the mesh does not fit the scene"},
    // coupler
    FindingId{answer, "surfaces-apart", "surfaces that move together differ in size or position"},
    FindingId{answer, "structure-at-rest", "a loaded structure has not moved for ten steps"},
    FindingId{answer, "unconverged-step",
              "a step of an iterated coupling was accepted before it had converged"},
    FindingId{answer, "velocity-and-displacement",
              "a participant gives a velocity that is not the rate of the displacement beside it"},
    FindingId{answer, "interface-oscillation",
              "the interface oscillates from step to step with growing amplitude"},
    FindingId{answer, "interface-work-grows",
              "the work on the two sides of the interface increasingly differs"},
    FindingId{answer, "interface-work", "work given and work taken over the whole run differ"},
    FindingId{answer, "iteration-of-pressure-and-structure",
              "one pass per step is near its added-mass limit"},
    FindingId{neglected, "viscous-coupling-load", "no structure takes the forces that the fluid gives"},
    // fluid_solver
    FindingId{answer, "flow-through-openings", "fluid leaves through an inlet or enters through an outlet"},
    FindingId{answer, "given-step", "a prescribed time step far too long for the viscous term on this mesh"},
    FindingId{answer, "balance-of-the-kinetic-energy", "the flow has kinetic energy that no work explains"},
    FindingId{answer, "resolved-walls", "a turbulence model on walls that the mesh does not resolve"},
    FindingId{answer, "eddy-viscosity-in-two-dimensions",
              "a turbulence model in two dimensions, where it is added friction only"},
    FindingId{answer, "walls-that-move-along-themselves", "fluid crosses a moving wall on a mesh at rest"},
    FindingId{answer, "gaps-that-close", "gaps block most of the cells"},
    FindingId{answer, "ringing-pressure", "waves that no step resolves ring in a trapezoidal rule"},
    FindingId{answer, "small-changes-of-density", "a weakly compressible fluid changes its density too much"},
    FindingId{neglected, "turbulence-model", "the mesh does not resolve layers of this Reynolds number"},
    FindingId{neglected, "compressibility", "the Mach number is high"},
    FindingId{neglected, "waves-of-pressure", "pressure waves or the fluid's compliance matter"},
    FindingId{neglected, "mesh-motion", "an interface moves, but the mesh does not"},
    // solid_solver
    FindingId{answer, "stress-error",
              "estimated error of the stress at a probe, and of the largest equivalent stress"},
    FindingId{answer, "quantity-error", "estimated error of a quantity of interest"},
    FindingId{answer, "strain-energy", "work and strain energy, or two face gradients, disagree"},
    FindingId{answer, "energy-growth", "the motion has more energy than was supplied"},
    FindingId{answer, "heat-swing", "the temperature oscillates from step to step"},
    FindingId{answer, "buckling", "the loads of a linear static run are near or above the buckling loads"},
    FindingId{answer, "unstable-equilibrium", "the computed equilibrium is unstable"},
    FindingId{answer, "limit-load", "a run by arc length passed a maximum or minimum of the load"},
    FindingId{neglected, "inertia", "a static run under a load that inertia would resist"},
    FindingId{neglected, "geometric-non-linearity", "large displacement gradients in a linear run"},
    FindingId{neglected, "yielding", "the stress exceeds the yield strength"},
    FindingId{neglected, "near-incompressibility",
              "Poisson's ratio near 0.5 without one volume strain per cell"},
    FindingId{neglected, "thermal-strain", "temperatures that would strain the body"},
    FindingId{neglected, "thermoelastic-coupling", "heat of deformation would stiffen the body"},
    // plate_modal
    FindingId{answer, "balance-of-the-energies", "the energies of the modes do not balance"},
    FindingId{answer, "step-that-resolves-the-modes", "moving modes have fewer than ten steps per period"},
    FindingId{answer, "step-near-a-resonance", "a load near a resonance and a step that shifts it"},
    FindingId{answer, "step-that-resolves-the-load", "the load changes within a step"},
    FindingId{answer, "step-that-resolves-the-contact", "an impact is shorter than ten steps"},
    FindingId{answer, "deflection-beyond-the-modes", "the loads excite truncated modes"},
    FindingId{answer, "load-faster-than-the-modes", "the load oscillates faster than the highest mode kept"},
    FindingId{answer, "initial-velocity-beyond-the-modes", "the modes cannot represent the initial velocity"},
    FindingId{answer, "load-between-the-faces-or-steps", "the load falls between faces or steps"},
    FindingId{answer, "load-that-moves-no-mode", "the load excites no mode"},
    FindingId{answer, "load-within-a-face", "the load varies within a face"},
    FindingId{answer, "mesh-that-resolves-the-modes", "the mesh does not resolve the moving modes"},
    FindingId{neglected, "large-rotation", "rotations too large for linear modes"},
    FindingId{neglected, "motion-in-the-plane", "loads in the plane of the plate"},
    FindingId{neglected, "stretch-of-the-mid-surface", "deflection that stretches the mid-surface"},
    FindingId{neglected, "shear-and-rotary-inertia", "modes with wavelengths too short for a thin plate"},
    // thermocline
    FindingId{answer, "weather-data", "the weather is questionable"},
    FindingId{answer, "calendar", "the plant's calendar is questionable"},
    FindingId{answer, "prices", "prices of items that the plant does not have"},
    FindingId{answer, "tank-state", "the tank has left the validity range of its closures"},
    FindingId{answer, "day-report", "the report has no valid basis"},
    FindingId{answer, "flow-schedule", "rows of the flow schedule that never ran"},
    FindingId{answer, "never-melted", "a phase-change filler that never melted"},
    FindingId{answer, "implicit-advection", "the time step smears the thermocline"},
    FindingId{answer, "work-of-pump-or-fan", "pump or fan consume a large share of the heat"},
    FindingId{neglected, "mixing-of-inverted-fluid", "cold fluid above hot that would sink"},
    FindingId{neglected, "resolved-grains", "grains with a temperature gradient inside"},
    FindingId{neglected, "pressure-loss-of-the-bed", "the bed's pressure loss consumes a share of the heat"},
    FindingId{neglected, "yielding-of-the-wall", "the wall would yield"},
    FindingId{neglected, "bending-of-the-wall", "bending adds to the wall's stress"},
    FindingId{neglected, "compressible-flow-of-a-gas", "the gas flows at a high Mach number"},
    FindingId{neglected, "specific-heat-of-a-gas-by-its-temperature", "the specific heat varies"},
};

}  // namespace

std::span<const FindingId> finding_ids() { return ids; }

}  // namespace couplet::log
