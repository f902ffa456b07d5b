// SPDX-License-Identifier: Apache-2.0
#include "solid_solver/effects/effect_cards.hpp"

#include <algorithm>
#include <array>

#include "solid_solver/method/solution_method.hpp"

namespace couplet::solid {
namespace {

using P = SolidParameters;

bool is_dynamic(const P& p) { return p.analysis == P::Analysis::dynamic; }
bool is_elastic(const P& p) { return p.analysis != P::Analysis::thermal; }
std::string when(bool on, const char* reason) { return on ? reason : ""; }

bool varies(const P& p) {
  return std::ranges::any_of(
      materials_of(p), [](const SolidMaterial& m) { return m.heat.youngs_modulus || m.heat.poissons_ratio; });
}

const std::array cards{
    SolidCard{"inertia", "`analysis: dynamic`",
              [](const P& p) { return when(is_dynamic(p), "analysis: dynamic"); },
              "velocities, a mass in the matrix", "inertia over load, 0.01"},
    SolidCard{
        "geometric non-linearity", "`kinematics: finite-strain`",
        [](const P& p) { return when(has_finite_strain(p), "kinematics: finite-strain"); },
        "per face F and the derivatives of the material law, Newton's method; `type: segregated` uses the "
        "updated-Lagrangian method of the thesis instead, at 9 to 17 times the solution time",
        "largest displacement gradient, 0.02"},
    SolidCard{"yielding", "not available here", [](const P&) { return std::string(); }, "",
              "where `yield-strength` is given: equivalent stress over it, 1"},
    SolidCard{
        "near incompressibility",
        "`solution-method: {face-gradient: symmetric, volume-strain: cells}` (or `shared`)",
        [](const P& p) { return when(has_volume_strain_of_cells(p), "one volume strain per cell"); },
        "a mean stress per cell, a pass over the faces; from nu = 0.49, without factors, also an unknown "
        "per cell",
        "largest Poisson's ratio, 0.45"},
    SolidCard{"orthotropic elasticity", "`material.orthotropic`",
              [](const P& p) { return when(is_elastic(p) && has_orthotropic(p), "orthotropic"); },
              "21 constants per face (6 in two dimensions) instead of 2"},
    SolidCard{"gravity", "`gravity`", [](const P& p) { return when(!p.gravity.empty(), "gravity"); },
              "a load per cell"},
    SolidCard{"body force", "`body-force`",
              [](const P& p) { return when(!p.body_force.empty(), "body-force"); }, "a load per cell"},
    SolidCard{
        "contact with a seat", "`contact`", [](const P& p) { return when(p.contact.has_value(), "contact"); },
        "gap and stiffness of the faces towards the seat; a look at them in each solve, and while they touch "
        "corrections, each with a linear solve; contact.csv"},
    SolidCard{"structural damping", "`damping`",
              [](const P& p) { return when(p.damping.has_value(), "damping"); }, "",
              "reported for every dynamic run without it"},
    SolidCard{"conduction of heat", "`heat`", [](const P& p) { return when(p.heat.has_value(), "heat"); },
              "a temperature, its matrix and solver"},
    SolidCard{"thermal strain", "`thermal-expansion`",
              [](const P& p) { return when(p.expansion.has_value(), "thermal-expansion"); },
              "a temperature per face", "strain of a free body over the displacement gradient, 0.02"},
    SolidCard{"thermoelastic coupling", "`thermoelastic-coupling: true`",
              [](const P& p) { return when(p.thermoelastic_coupling, "thermoelastic-coupling"); },
              "a strain rate per cell", "stiffening by heat of deformation, 0.05"},
    SolidCard{"properties of temperature", "`youngs-modulus-table`, `poissons-ratio-table`",
              [](const P& p) { return when(varies(p), "a table of the material"); },
              "Lame's constants per cell; the matrix is reassembled when they change"},
    SolidCard{"third dimension", "`dimension: 3`",
              [](const P& p) { return when(p.dimension == 3, "dimension: 3"); }},
    SolidCard{"energies", "`output.energies: true`",
              [](const P& p) { return when(p.output.energies, "output.energies"); },
              "energies.csv, work of the step summed over the faces"},
    SolidCard{"free vibrations", "`output.modes` above 0",
              [](const P& p) { return when(p.output.modes > 0, "output.modes"); },
              "modes.csv and modes.h5, computed once at the start: factors of the shifted stiffness with the "
              "vertices as unknowns, and about forty solutions with them"},
};

}  // namespace

bool has_volume_strain_of_cells(const SolidParameters& p) {
  return is_elastic(p) && face_gradient_scheme(p) == elastic::FaceGradientScheme::symmetric &&
         volume_strain_of(p) != elastic::VolumeStrain::faces;
}

std::span<const SolidCard> solid_effect_cards() { return cards; }

}  // namespace couplet::solid
