// SPDX-License-Identifier: Apache-2.0
#include "fluid_solver/parameters/effect_cards.hpp"

#include <algorithm>
#include <array>

namespace couplet::fluid {
namespace {

using S = FluidScene;

std::string when(bool on, const char* reason) { return on ? reason : ""; }

template <class Test>
bool has_boundary(const S& s, const Test& test) {
  return std::ranges::any_of(s.parameters.boundaries, [&](const auto& b) { return test(b.second); });
}

bool has_interface(const S& s) {
  return has_boundary(s, [](const auto& b) { return condition_of(b).velocity == GivenBy::structure; });
}

const std::array cards{
    FluidCard{
        "turbulence model", "`turbulence` in three dimensions",
        [](const S& s) { return when(s.parameters.turbulence && s.parameters.dimension == 3, "turbulence"); },
        "an eddy viscosity per cell, a velocity gradient per step",
        "max cell Reynolds number, 50, or 250 with resolved walls (y+ up to 1); beyond that the flow's own by the hydraulic "
        "diameter, 3450: laminar below"},
    FluidCard{
        "eddy viscosity in two dimensions", "`turbulence` in two dimensions, where it models no turbulence",
        [](const S& s) { return when(s.parameters.turbulence && s.parameters.dimension == 2, "turbulence"); },
        "as a turbulence model", "max eddy viscosity over the molecular, 0.01", true},
    FluidCard{"resolved walls", "`turbulence`",
              [](const S& s) { return when(s.parameters.turbulence.has_value(), "turbulence"); }, "",
              "with a turbulence model: max y+, 2", true},
    FluidCard{"balance of the kinetic energy", "always", [](const S&) { return std::string("always"); },
              "a loop over the boundary", "kinetic energy without work, of the total, 0.1", true},
    FluidCard{"compressibility", "not available here", [](const S&) { return std::string(); }, "",
              "max speed over the speed of sound (`compressibility`, or by density and viscosity), 0.3"},
    FluidCard{
        "waves of pressure", "`compressibility`",
        [](const S& s) { return when(s.parameters.is_compressible(), "compressibility"); },
        "three pressures per cell in the right side of the pressure equation, whose matrix changes with the step",
        "density change by the pressure range, 0.05; for moving walls: compressed over displaced volume, "
        "0.1, and travel time of sound across the fluid over 1/omega of the wall motion, 0.3"},
    FluidCard{"small changes of density", "`compressibility`",
              [](const S& s) { return when(s.parameters.is_compressible(), "compressibility"); }, "",
              "with `compressibility`: density change by the pressure range, 0.05", true},
    FluidCard{
        "mesh motion", "a mesh mover in `coupling.mesh`, or `motion`",
        [](const S& s) { return when(s.moving_mesh, s.parameters.motion ? "motion" : "coupling.mesh"); },
        "points, swept volumes, geometry of each step; without `motion` the process mesh_mover",
        "for an interface: max displacement over the cell height, 0.1"},
    FluidCard{"moving frame", "`motion` with only a `translation`",
              [](const S& s) {
                return when(s.parameters.motion && s.parameters.motion->translates(), "motion.translation");
              },
              "geometry, pressure matrix and factors are computed once"},
    FluidCard{"rotating frame", "`rotating-frame`",
              [](const S& s) { return when(s.parameters.rotating_frame.has_value(), "rotating-frame"); },
              "a force per cell"},
    FluidCard{"coupling load", "a boundary of `type: interface`",
              [](const S& s) { return when(s.coupled && has_interface(s), "a boundary of type interface"); },
              "forces per interface face"},
    FluidCard{"implicit sub-steps bounded by accuracy", "`implicit-stretch`",
              [](const S& s) { return when(s.parameters.implicit_stretch.has_value(), "implicit-stretch"); },
              "up to as many more sub-steps as the stability limit exceeds this bound"},
    FluidCard{
        "walls that yield (Robin interface)",
        "`surface-density` or `impedance` of a boundary of type interface",
        [](const S& s) {
          return when(
              std::ranges::any_of(s.parameters.boundaries, [](const auto& b) { return b.second.foresees(); }),
              "surface-density");
        },
        "two loops over the interface per pass, a pressure per face in the coupling; a new pressure matrix "
        "where the step is halved"},
    FluidCard{"pressure level of a closed fluid", "`volume-level: structure`",
              [](const S& s) {
                return when(s.parameters.volume_level == VolumeLevelBy::structure, "volume-level: structure");
              },
              "one or two more structure steps per pass, an inflow per interface face"},
    FluidCard{"immersed bodies", "`bodies`",
              [](const S& s) { return when(!s.parameters.bodies.empty(), "bodies"); },
              "a flag per cell and face"},
    FluidCard{"gaps that close", "`gaps`",
              [](const S& s) { return when(!s.parameters.gaps.empty(), "gaps"); },
              "a flag per cell; the distance of the two walls where they are close",
              "share of the cells that they block, 0.5", true},
    FluidCard{"walls that move along themselves", "`type: moving-wall`",
              [](const S& s) {
                for (const auto& [name, b] : s.parameters.boundaries)
                  if (is_moving_wall(b)) return "boundaries." + name;
                return std::string();
              },
              "", "on a mesh at rest: flow through them over speed times area, 0.1", true},
    FluidCard{"body force", "`body-force`",
              [](const S& s) { return when(!s.parameters.body_force.empty(), "body-force"); },
              "a force per cell"},
    FluidCard{"third dimension", "`dimension: 3`",
              [](const S& s) { return when(s.parameters.dimension == 3, "dimension: 3"); }},
    FluidCard{"running statistics", "`statistics`",
              [](const S& s) { return when(s.parameters.statistics.has_value(), "statistics"); },
              "sums of velocity, pressure and their squares per cell"},
    FluidCard{"lines and planes", "`output.samples`",
              [](const S& s) { return when(!s.parameters.output.samples.empty(), "output.samples"); },
              "interpolation at their points and files at the outputs"},
    FluidCard{"velocity from a file", "`table` of an inlet or moving wall",
              [](const S& s) {
                return when(has_boundary(s, [](const auto& b) { return b.table.has_value(); }), "table");
              },
              "the table; a look-up per face of the patch"},
    FluidCard{"rotating inlet or wall", "`rotation` of an inlet or moving wall",
              [](const S& s) {
                return when(has_boundary(s, [](const auto& b) { return b.rotation.has_value(); }),
                            "rotation");
              },
              ""},
    FluidCard{"vorticity and Q", "`output.vorticity`, `output.q-criterion`",
              [](const S& s) {
                return when(s.parameters.output.vorticity || s.parameters.output.q_criterion, "output");
              },
              "fields at the outputs"},
    FluidCard{"energy budget", "`output.energy-budget`",
              [](const S& s) { return when(s.parameters.output.energy_budget, "output.energy-budget"); },
              "energy.csv, work of the step summed over the faces"},
};

}  // namespace

std::span<const FluidCard> fluid_effect_cards() { return cards; }

}  // namespace couplet::fluid
