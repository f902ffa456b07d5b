// SPDX-License-Identifier: Apache-2.0
#include "common/config/missing_physics.hpp"

#include <fmt/format.h>

#include <cctype>

#include "common/base/text.hpp"

namespace couplet::config {
namespace {

constexpr std::string_view fluid = "fluid_solver", solid = "solid_solver", plate = "plate_modal",
                           mover = "mesh_mover", tank = "thermocline", coupling;

constexpr std::string_view
    no_plasticity = "no plasticity, creep or viscoelasticity",
    use_calculix =
        "give 'yield-strength' for every metal, so that yielding is reported; beyond it use CalculiX",
    inelastic =
        "plastic plasticity elastoplastic elasto-plastic elastic-plastic viscoplastic yield-stress "
        "hardening yield-curve johnson-cook von-mises drucker-prager mohr-coulomb creep norton "
        "viscoelastic viscoelasticity prony maxwell kelvin-voigt relaxation-time shape-memory";

// A shorter word must be the whole key or value, as "heat", which is also part of "heat-capacity-ratio".
constexpr std::size_t shortest_part = 5;

constexpr MissingPhysics table[] = {
    {fluid,
     "shock shocks supersonic transonic hypersonic mach ideal-gas equation-of-state gas-constant rhocentral",
     "no shocks and no transonic or supersonic flow; compressibility covers pressure waves of small amplitude",
     "use a compressible solver, such as OpenFOAM or SU2, and couple it through preCICE's interface"},
    {fluid,
     "free-surface vof volume-of-fluid level-set two-phase multiphase phase phases phase-change surface-tension contact-angle "
     "cavitation vapor-pressure vapour-pressure bubble bubbles",
     "no free surface, no two-phase flow, no cavitation",
     "check the lowest pressure; use another fluid solver"},
    {fluid,
     "k-omega k-epsilon kepsilon komega komegasst kwsst sst spalart-allmaras rans urans des ddes iddes realizable "
     "reynolds-stress rsm v2f laminar-turbulent turbulent-kinetic-energy turbulence-intensity turbulent-viscosity "
     "eddy-viscosity-ratio mixing-length wall-function wall-functions roughness",
     "no wall functions; Smagorinsky and WALE need a mesh that resolves the wall; no RANS models",
     "refine at the walls until y+ is about 1, or use another fluid solver"},
    {fluid, "conjugate-heat-transfer cht conjugate heat-interface",
     "no radiation or contact resistance between a fluid and a solid, and no heat between them and a tank",
     "set conjugate: true in the fluid and type: interface in heat.boundaries of the solid, or couple an external program"},
    {fluid,
     "temperature thermal heat-transfer conductivity specific-heat thermal-diffusivity prandtl rayleigh buoyancy boussinesq "
     "expansion energy-equation natural-convection viscous-heating dissipation heat-source",
     "heat in the fluid has constant properties but for the viscosity, no sources and no heating by friction, and its buoyancy is that of Boussinesq",
     "set the section heat and the temperature, heat-flux or film of the patches"},
    {fluid, "casson quemada sutherland oldroyd oldroyd-b viscoelastic thixotropic mixture",
     "constant density, and a viscosity that is constant or a function of the shear rate: no mixtures, no viscoelastic fluids",
     "another fluid solver"},
    {fluid,
     "species scalar passive-scalar concentration mass-fraction diffusivity particle particles dpm sediment combustion "
     "reaction reactions chemistry radiation magnetic mhd electric",
     "no transported species or particles, no chemistry, no electromagnetic forces", "another fluid solver"},
    {fluid, "axisymmetric axisymmetry axi-symmetric axial-symmetry swirl wedge", "no axisymmetric flow",
     "compute a wedge or the full domain in three dimensions"},
    {fluid, "steady steady-state stationary pseudo-transient pseudo-time simple simplec",
     "no steady-state solver: every flow is computed as a transient",
     "start from rest with a constant inflow and run until drag, lift or probes no longer change"},
    {fluid,
     "porous porosity permeability darcy forchheimer brinkman porous-zone porous-jump momentum-source actuator fan",
     "no porous media, no fans and no local momentum sources in the fluid",
     "mesh the passages, or use another fluid solver"},
    {fluid,
     "resistance windkessel rcr lumped impedance compliance capacitance flow-resistance loss-coefficient pressure-drop inertance "
     "circulation closed-loop heart ventricle",
     "no circuits behind openings but a resistance, a windkessel or a pressure drop of an outlet: no inertance, no valves, no "
     "closed circulation, none behind an inlet",
     "use type: outlet with resistance, windkessel or pressure-drop, and an inlet with a flow rate that repeats"},
    {solid, inelastic, no_plasticity, use_calculix},
    {plate, inelastic, no_plasticity, use_calculix},
    {solid, "fracture damage crack cohesive delamination debonding failure fatigue phase-field xfem erosion",
     "no fracture, damage or delamination", "check the largest stress against the strength"},
    {solid, "contact self-contact contact-pair contact-pairs friction frictional",
     "no contact between deformable bodies and no self-contact; a plate or solid may touch one rigid seat without friction",
     "check the gap between the bodies; use CalculiX or solids4foam"},
    {solid, "beam beams shell shells membrane truss cable rod",
     "no beam, shell or membrane elements; thin plates are linear and represented by modes",
     "use solid_solver with a few cells across the thickness"},
    {solid,
     "porous poroelastic poroelasticity biot permeability pore-pressure consolidation piezoelectric magnetic electric "
     "swelling moisture radiation emissivity phase-change latent-heat melting",
     "no pore pressure, no electric or magnetic fields, no radiation and no phase change in solids",
     "use another solver, or couple a program of your own"},
    {solid,
     "harmonic frequency-response steady-state-dynamics random-vibration response-spectrum psd complex-modes",
     "no response in the frequency domain",
     "compute a transient with output.spectrum, or combine the modes of 'analysis: modal' yourself"},
    {mover, "remesh remeshing adaptive refinement topology overset chimera sliding-interface ami",
     "meshes move, but are not regenerated, and their topology stays the same",
     "use gaps for valves that close, or bodies for parts that pass each other (immersed-seat)"},
    {fluid, "overset chimera sliding-interface sliding-mesh ami remesh remeshing adaptive amr refinement",
     "meshes move, but are not regenerated, and their topology stays the same",
     "use gaps for valves that close, or bodies for parts that pass each other (immersed-seat)"},
};

/// A key or word that is gone, exactly as it was written. Sections of no program, as `coupling`, have none.
struct Removed {
  std::string_view program, words, instead;
};

constexpr Removed removed[] = {
    {coupling, "error-estimate", "set 'diagnostics: without-errors' for 'error-estimate: false'"},
    {coupling, "neglected-share", "set 'neglected-limit', the new name of this key"},
    {coupling, "both min-iterations", "remove it: a step converges if the absolute or relative limit is met"},
    {coupling, "maximum-columns", "remove it, or set 'reused-steps'"},
    {coupling, "waveform", "remove it: the input of sub-steps is interpolated linearly in time"},
    {coupling, "on-divergence", "remove it, or set 'simulation: {accept: [interface-oscillation]}'"},
    {coupling, "interface-output",
     "use the field output of the programs, or integrate data with 'coupling.watch'"},
    {coupling, "part", "remove it: forces.csv of the fluid lists the forces on each patch"},
    {coupling, "rbf", "set 'type: projection'"},
    {fluid, "scheme runge-kutta", "remove it, and use a third of the time step"},
    {fluid, "upstream-line", "mesh the tube, or set 'upstream-volume'"},
    {fluid, "substance heat-capacity-ratio", "set 'speed-of-sound'"},
    {solid, "corrected", "set 'face-gradient: symmetric', the default"},
    {solid, "deformed", "displace the mesh in the program that displays the fields"},
    {solid, "principal-stress", "read it at probes, or compute it from 'stress'"},
    {solid, "moment-centre", "subtract the cross product of the center and the force"},
    {solid, "stiffness-tolerance linear-tolerance longest", "remove it"},
    {tank, "coldest warmest", "set their mean, 'temperature'"},
    {tank,
     "wall-film wall-coefficient emissivity-liquid emissivity-roof emissivity-wall cover-emissivity roof-pressure "
     "deep-temperature outlet-margin dead-state solar-absorptance site longitude time-zone shift days humidity lowest "
     "highest capsules",
     "remove it"},
};

}  // namespace

std::span<const MissingPhysics> missing_physics() { return table; }

std::string limit_named_by(std::string_view key_or_value, std::string_view program) {
  for (const Removed& row : removed)
    if (row.program == program)
      for (const std::string& word : base::split(row.words, ' '))
        if (word == key_or_value)
          return fmt::format("This key or value was removed (CHANGELOG.md). Instead: {}.", row.instead);
  std::string text = "-";
  for (const char c : key_or_value)
    text += c == '_' || c == ' ' ? '-' : static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  text += '-';
  for (const MissingPhysics& row : table) {
    if (row.program != program) continue;
    for (const std::string& word : base::split(row.words, ' ')) {
      const bool is_named = word.size() < shortest_part
                                ? text.size() == word.size() + 2 && text.substr(1, word.size()) == word
                                : text.find("-" + word + "-") != std::string::npos;
      if (is_named)
        return fmt::format("This is a limit of Couplet: {}. Instead: {} (docs/limitations.md).", row.limit,
                           row.instead);
    }
  }
  return "";
}

}  // namespace couplet::config
