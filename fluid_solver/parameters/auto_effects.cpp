// SPDX-License-Identifier: Apache-2.0
#include "fluid_solver/parameters/auto_effects.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "common/fv/expression.hpp"

namespace couplet::fluid {
namespace {

constexpr double laminar = 2300;  // of a channel or pipe
constexpr double resolved = 10;   // cell Reynolds number of a mesh that needs no model
constexpr int samples = 20;

double largest(const std::vector<config::ExpressionText>& components, const mesh::MeshFacts& mesh,
               double end) {
  double most = 0;
  std::vector<fv::Expression> parts;
  for (const auto& text : components) parts.emplace_back(text, "velocity");
  for (int i = 0; i <= samples; ++i)
    for (int k = 0; k <= samples; ++k) {
      double squared = 0;
      for (const fv::Expression& part : parts) {
        const double value = part(double(k) / samples * mesh.size, end * i / samples);
        squared += value * value;
      }
      most = std::max(most, std::sqrt(squared));
    }
  return most;
}

double speed_of(const FluidParameters& p, const mesh::MeshFacts& mesh, double end) {
  double speed = largest(p.initial_velocity, mesh, 0);
  for (const auto& [name, b] : p.boundaries) {
    speed = std::max(speed, largest(b.velocity, mesh, end));
    if (b.mean_speed) speed = std::max(speed, largest({*b.mean_speed}, mesh, end));
  }
  return speed;
}

effects::EffectChoice turbulence(const FluidParameters& p, const mesh::MeshFacts& mesh, double speed) {
  const auto without = [](std::string reason) {
    return effects::EffectChoice{"turbulence", "", "none, laminar", std::move(reason), false};
  };
  if (mesh.dim == 2) return without("eddies are three-dimensional");
  if (!(speed > 0)) return without("no boundary or initial condition sets a speed");
  const double nu = p.kinematic_viscosity();
  if (!(nu > 0)) return without("inviscid fluid");
  const double reynolds = speed * mesh.smallest_side() / nu, cell = speed * mesh.mean_cell / nu;
  if (reynolds < laminar)
    return without(fmt::format("Reynolds number {:.3g}, below {:g}", reynolds, laminar));
  if (cell < resolved)
    return without(
        fmt::format("the mesh resolves it: Reynolds number {:.3g}, {:.2g} per cell", reynolds, cell));
  return {"turbulence", "{model: wale}", "wale",
          fmt::format("Reynolds number {:.3g}, {:.3g} per cell: the mesh does not resolve the eddies",
                      reynolds, cell),
          false};
}

/// Explicit diffusion holds to nu dt (sum of 4/h^2) <= 1, convection to about half a cell a step: the implicit term costs about
/// as much as two explicit steps.
effects::EffectChoice viscous(const FluidParameters& p, const mesh::MeshFacts& mesh, double speed) {
  const double nu = p.kinematic_viscosity(), h = mesh.shortest_edge;
  const double diffusion = nu > 0 ? h * h / (4 * mesh.dim * nu) : std::numeric_limits<double>::infinity();
  const double convection = speed > 0 ? 0.5 * h / speed : std::numeric_limits<double>::infinity();
  const bool implicit = diffusion < 0.5 * convection && !std::isinf(diffusion);
  const char* word = implicit ? "implicit" : "explicit";
  const bool rungs = p.scheme == ExplicitScheme::runge_kutta;
  return {"viscous", rungs ? "explicit" : word, rungs ? "explicit" : word,
          rungs ? "'scheme: runge-kutta' is explicit"
                : fmt::format("diffusion allows steps of {:.2g} s, convection of {:.2g} s", diffusion,
                              convection),
          false};
}

effects::EffectChoice mesh_motion(const FluidParameters& p, const effects::ChoiceScene& scene) {
  if (scene.has_mover) return {"", "", "moving mesh", "'coupling.mesh' names a mesh mover", false};
  if (p.motion) return {"", "", "moving mesh", "'motion' prescribes it", false};
  const bool interface = std::ranges::any_of(
      p.boundaries, [](const auto& b) { return condition_of(b.second).velocity == GivenBy::structure; });
  if (scene.coupled && interface)
    return {"", "", "mesh at rest",
            "no mesh mover: the run reports if the interface moves by more than a tenth of a cell", false};
  return {"", "", "mesh at rest", "nothing moves", false};
}

}  // namespace

std::vector<effects::EffectChoice> choose_effects(const FluidParameters& p, const mesh::MeshFacts& mesh,
                                                  const effects::ChoiceScene& scene) {
  const double speed = speed_of(p, mesh, scene.end_time);
  return {{"dimension", std::to_string(mesh.dim), std::to_string(mesh.dim),
           mesh.dim == 2 ? "the mesh has two-dimensional cells only" : "the mesh has volumes", false},
          turbulence(p, mesh, speed),
          viscous(p, mesh, speed),
          choose_waves(p, mesh, scene),
          mesh_motion(p, scene)};
}

effects::ExpectedCost expected_cost(const FluidParameters& p, const mesh::MeshFacts& mesh) {
  // Measured: 35 and 145 MB with 4096 and 65536 cells in 2-D, 35 and 144 MB with 4096 and 64000 in 3-D.
  const double cells = double(mesh.cells), eddies = p.turbulence ? 8 : 0;
  return {mesh.cells, 28e6 + (1800 + eddies) * cells, 2e-6 * cells};
}

}  // namespace couplet::fluid
