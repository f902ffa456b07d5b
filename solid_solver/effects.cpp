// SPDX-License-Identifier: Apache-2.0
#include "solid_solver/effects.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "common/fv/expression.hpp"
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
              "velocities, a mass in the matrix", "inertia over load"},
    SolidCard{
        "geometric non-linearity", "`kinematics: finite-strain`",
        [](const P& p) { return when(has_finite_strain(p), "kinematics: finite-strain"); },
        "per face F and the derivatives of the material law, Newton's method; `type: segregated` uses the "
        "updated-Lagrangian method of the thesis instead, at 9 to 17 times the solution time",
        "estimated change of the displacement; unknown where that is not estimated, with a warning from a displacement gradient of 0.02"},
    SolidCard{
        "yielding", "not available here", [](const P&) { return std::string(); }, "",
        "equivalent stress over `yield-strength`; unknown without one, from 0.01 of Young's modulus of a metal (for information from 0.002)"},
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
              "a load per cell",
              "for information: work of the weight on the displacement over that of the loads"},
    SolidCard{"body force", "`body-force`",
              [](const P& p) { return when(!p.body_force.empty(), "body-force"); }, "a load per cell"},
    SolidCard{
        "contact with a seat", "`contact`", [](const P& p) { return when(p.contact.has_value(), "contact"); },
        "gap and stiffness of the faces toward the seat; a look at them in each solve, and while they touch "
        "corrections, each with a linear solve; contact.csv"},
    SolidCard{"damping", "`damping`", [](const P& p) { return when(p.damping.has_value(), "damping"); }, "",
              "for information: share of the motion that 2 % of the critical damping would take"},
    SolidCard{"conduction of heat", "`heat`", [](const P& p) { return when(p.heat.has_value(), "heat"); },
              "a temperature, its matrix and solver"},
    SolidCard{"storage of heat", "`heat: {analysis: transient}`",
              [](const P& p) {
                return when(p.heat && p.heat->analysis == HeatParameters::Analysis::transient, "heat");
              },
              "", "of a steady temperature that changes: time in which heat spreads over that of the change"},
    SolidCard{"thermal strain", "`thermal-expansion`",
              [](const P& p) { return when(p.expansion.has_value(), "thermal-expansion"); },
              "a temperature per face",
              "strain of a free body over the displacement gradient; for information without an `expansion`"},
    SolidCard{"thermoelastic coupling", "`thermoelastic-coupling: true`",
              [](const P& p) { return when(p.thermoelastic_coupling, "thermoelastic-coupling"); },
              "a strain rate per cell", "stiffening by heat of deformation"},
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

namespace {

/// Number of periods in a ramp that leaves 1 % of overshoot.
constexpr double slow = 30;
constexpr int samples = 400;

std::vector<config::ExpressionText> loads_of(const SolidParameters& p) {
  std::vector<config::ExpressionText> loads = p.body_force;
  const auto add = [&](const SolidCondition& c) {
    loads.insert(loads.end(), c.value.begin(), c.value.end());
    loads.insert(loads.end(), c.traction.begin(), c.traction.end());
    for (const auto& component : c.components)
      if (component) loads.push_back(*component);
    loads.push_back(c.pressure);
  };
  for (const auto& [name, boundary] : p.boundaries) {
    add(boundary);
    for (const SolidPart& part : boundary.parts) add(part);
  }
  if (p.temperature) loads.push_back(*p.temperature);
  return loads;
}

/// Shortest time in which a load passes through its range [s]; infinity if none changes. A load present from
/// the start is no change, because the body starts at rest under it.
double time_of_change(const std::vector<config::ExpressionText>& loads, const Vec3& at, double end) {
  double shortest = std::numeric_limits<double>::infinity();
  for (const auto& text : loads) {
    const fv::Expression load(text, "load");
    if (!load.uses_time()) continue;
    double low = load(at, 0), high = low, before = low, fastest = 0;
    for (int i = 1; i <= samples; ++i) {
      const double now = load(at, end * i / samples);
      low = std::min(low, now), high = std::max(high, now);
      fastest = std::max(fastest, std::abs(now - before) * samples / end);
      before = now;
    }
    if (fastest > 0) shortest = std::min(shortest, (high - low) / fastest);
  }
  return shortest;
}

double lowest_period(const SolidParameters& p, const mesh::MeshFacts& mesh) {
  double slowest = 0;
  for (const SolidMaterial& m : materials_of(p))
    for (const double e : m.orthotropic ? m.orthotropic->youngs_moduli : std::vector{m.youngs_modulus})
      if (e > 0) slowest = std::max(slowest, std::sqrt(m.density / e));
  const double length = mesh.largest_side(), height = std::max(mesh.smallest_side(), 1e-300);
  return 2 * std::numbers::pi * length * length / (3.516 * height) * std::sqrt(12.0) * slowest;
}

diagnostics::EffectChoice inertia(const SolidParameters& p, const mesh::MeshFacts& mesh,
                                  const diagnostics::CaseScene& scene) {
  const auto choose = [](bool dynamic, std::string reason) {
    const char* word = dynamic ? "dynamic" : "static";
    return diagnostics::EffectChoice{"analysis", word, word, std::move(reason), false};
  };
  const bool takes_forces = !(p.interface_data && p.interface_data->temperature);
  const bool has_interface =
      std::ranges::any_of(p.boundaries, [](const auto& b) { return is_interface(b.second); });
  if (scene.coupled && has_interface && takes_forces)
    return choose(true, "the partner's forces vary in time");
  if (!p.initial_velocity.empty()) return choose(true, "'initial-velocity' is given");
  if (p.damping) return choose(true, "'damping' is given");
  if (p.time_scheme.type != time::TimeScheme::automatic) return choose(true, "'time-scheme' is given");
  const double change = time_of_change(loads_of(p), 0.5 * mesh.size, scene.end_time);
  if (std::isinf(change)) return choose(false, "no load varies in time");
  const double period = lowest_period(p, mesh);
  return choose(
      change < slow * period,
      fmt::format("the loads change within {:.3g} s, the lowest period is about {:.3g} s", change, period));
}

}  // namespace

std::vector<diagnostics::EffectChoice> choose_effects(const SolidParameters& p, const mesh::MeshFacts& mesh,
                                                      const diagnostics::CaseScene& scene) {
  std::vector<diagnostics::EffectChoice> choices{
      {"dimension", std::to_string(mesh.dim), std::to_string(mesh.dim),
       mesh.dim == 2 ? "the mesh has two-dimensional cells only" : "the mesh has volumes", false}};
  if (p.analysis != SolidParameters::Analysis::thermal) choices.push_back(inertia(p, mesh, scene));
  return choices;
}

diagnostics::ExpectedCost expected_cost(const SolidParameters& p, const mesh::MeshFacts& mesh) {
  // Measured in 3-D: 83 MB with 640 cells (factors, which grow as cells^(4/3)), 61 and 143 MB with 5120 and
  // 40960 (multigrid); in 2-D 54 and 156 MB with 1024 and 16384.
  const double cells = double(mesh.cells);
  const double flat = 6650 * cells,
               volume = cells <= 1500 ? 35e6 * std::pow(cells / 640, 4.0 / 3) : 2290 * cells;
  const double bytes = 48e6 + (mesh.dim == 3 ? volume : flat);
  const bool dynamic = p.analysis == SolidParameters::Analysis::dynamic;
  const double seconds = mesh.dim == 3 ? (dynamic ? 10e-6 : 40e-6) : (dynamic ? 0.5e-6 : 30e-6);
  return {mesh.cells, bytes, seconds * cells};
}

}  // namespace couplet::solid
