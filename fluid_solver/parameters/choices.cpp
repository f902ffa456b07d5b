// SPDX-License-Identifier: Apache-2.0
#include "fluid_solver/parameters/parameters.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "common/fv/expression.hpp"

namespace couplet::fluid {

namespace {

constexpr double slow_waves = 0.3;  // of the audit: travel time of sound over 1/omega
constexpr int most_samples = 2000, places = 4;

/// RMS rate of a prescribed quantity over its RMS fluctuation [1/s]; 0 if it is constant.
double rate_of(const config::ExpressionText& text, const Vec3& at, double end, double step) {
  const fv::Expression value(text);
  const int n = std::clamp(int(end / std::max(step, 1e-300)), 2, most_samples);
  const double dt = std::min(step, end / n);
  double last = value(at, 0), sum = last, square = last * last, changes = 0;
  for (int i = 1; i <= n; ++i) {
    const double now = value(at, i * dt);
    changes += (now - last) * (now - last) / (dt * dt);
    sum += now, square += now * now;
    last = now;
  }
  const double variance = square - sum * sum / (n + 1);
  return variance > 1e-9 * square ? std::sqrt(changes / variance) : 0;
}

/// Decides about pressure waves. They are computed if sound takes longer across the mesh than 0.3/omega of
/// boundaries and motions, if gaps cut off an inlet, or if an interface moves in a fluid without an outlet.
diagnostics::EffectChoice choose_waves(const FluidParameters& p, const mesh::MeshFacts& mesh,
                                       const diagnostics::CaseScene& scene) {
  const auto without = [](std::string reason) {
    return diagnostics::EffectChoice{"compressibility", "", "none, incompressible", std::move(reason)};
  };
  const auto with = [](std::string reason) {
    return diagnostics::EffectChoice{"compressibility", "{scheme: three-level}", "three-level",
                                     std::move(reason)};
  };
  const auto has = [&p](const auto& fact) {
    return std::ranges::any_of(p.boundaries, [&](const auto& b) { return fact(b.second); });
  };
  const auto velocity_by = [&has](GivenBy who) {
    return has([who](const BoundaryParameters& b) { return condition_of(b).velocity == who; });
  };
  const auto sound = sound_of({}, p.density, p.properties().mu);
  if (!sound) return without("a model fluid, whose speed of sound is not known");
  if (!p.bodies.empty() || p.rotating_frame || velocity_by(GivenBy::flow) || p.viscosity_law)
    return without("not available with 'bodies', 'rotating-frame' or a convective outlet");
  if (!p.gaps.empty() && has([](const auto& b) { return condition_of(b).passage == Passage::in; }))
    return with("inflow compresses a part that 'gaps' shut off");
  if (scene.coupled && p.volume_level == VolumeLevelBy::nobody && velocity_by(GivenBy::structure) &&
      !has(gives_pressure))
    return with("no outlet: an interface that moves compresses the fluid");
  const auto along_the_box = [&mesh](const std::string&) {
    std::vector<PlaceOfPatch> all;
    for (int i = 0; i <= places; ++i) all.push_back({double(i) / places * mesh.size});
    return all;
  };
  const double rate = prescribed_rate(p, along_the_box, scene.end_time, scene.time_step),
               phase = rate * mesh.largest_side() / sound->speed;
  const std::string reason = fmt::format(
      "the travel time of sound across {} is {:.2g} s = {:.2g} times the time scale 1/omega of the prescribed motion or flow",
      sound->of, mesh.largest_side() / sound->speed, phase);
  if (phase > slow_waves) return with(reason);
  return without(scene.coupled && velocity_by(GivenBy::structure)
                     ? reason + "; the run reports if the compliance or the waves matter to the interface"
                     : reason);
}

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
    if (b.flow_rate)
      speed =
          std::max(speed, largest({*b.flow_rate}, mesh, end) / std::pow(mesh.smallest_side(), mesh.dim - 1));
  }
  return speed;
}

diagnostics::EffectChoice turbulence(const FluidParameters& p, const mesh::MeshFacts& mesh, double speed) {
  const auto without = [](std::string reason) {
    return diagnostics::EffectChoice{"turbulence", "", "none, laminar", std::move(reason)};
  };
  if (mesh.dim == 2) return without("eddies are three-dimensional");
  if (!(speed > 0)) return without("no boundary or initial condition sets a speed");
  const double nu = p.viscosity_at(speed / mesh.smallest_side()) / p.density;
  if (!(nu > 0)) return without("inviscid fluid");
  if (p.viscosity_law) return without("not available with a law of 'viscosity'");
  const double reynolds = speed * mesh.smallest_side() / nu, cell = speed * mesh.mean_cell / nu;
  if (reynolds < laminar)
    return without(fmt::format("Reynolds number {:.3g}, below {:g}", reynolds, laminar));
  if (cell < resolved)
    return without(
        fmt::format("the mesh resolves it: Reynolds number {:.3g}, {:.2g} per cell", reynolds, cell));
  return {"turbulence", "{model: wale}", "wale",
          fmt::format("Reynolds number {:.3g}, {:.3g} per cell: the mesh does not resolve the eddies",
                      reynolds, cell)};
}

/// Explicit diffusion requires nu dt (sum of 4/h^2) <= 1, convection about half a cell per step. The implicit
/// term costs about two explicit steps.
diagnostics::EffectChoice viscous(const FluidParameters& p, const mesh::MeshFacts& mesh, double speed) {
  const double h = mesh.shortest_edge,
               nu = std::max(p.viscosity_at(0), p.viscosity_at(speed / h)) / p.density;
  const double diffusion = nu > 0 ? h * h / (4 * mesh.dim * nu) : std::numeric_limits<double>::infinity();
  const double convection = speed > 0 ? 0.5 * h / speed : std::numeric_limits<double>::infinity();
  const bool implicit = diffusion < 0.5 * convection && !std::isinf(diffusion);
  const char* word = implicit ? "implicit" : "explicit";
  return {"viscous", word, word,
          fmt::format("diffusion allows steps of {:.2g} s, convection of {:.2g} s", diffusion, convection)};
}

diagnostics::EffectChoice mesh_motion(const FluidParameters& p, const diagnostics::CaseScene& scene) {
  if (scene.has_mover) return {"", "", "moving mesh", "'coupling.mesh' names a mesh mover"};
  if (p.motion) return {"", "", "moving mesh", "'motion' prescribes the mesh motion"};
  const bool interface = std::ranges::any_of(
      p.boundaries, [](const auto& b) { return condition_of(b.second).velocity == GivenBy::structure; });
  if (scene.coupled && interface)
    return {"", "", "mesh at rest",
            "no mesh mover: the run reports if the interface moves by more than a tenth of a cell"};
  return {"", "", "mesh at rest", "nothing moves"};
}

}  // namespace

double prescribed_rate(const FluidParameters& p, const PlacesOfPatch& places_of, double end, double step) {
  double rate = 0;
  const auto add = [&](const std::string& patch, const std::vector<config::ExpressionText>& texts) {
    for (const PlaceOfPatch& place : places_of(patch))
      for (std::size_t k = 0; k < texts.size(); ++k)
        if (texts.size() == 1 || std::abs(place.normal[Index(k)]) > 1e-6)
          rate = std::max(rate, rate_of(texts[k], place.at, end, step));
  };
  for (const auto& [name, b] : p.boundaries) {
    const bool inlet = condition_of(b).passage == Passage::in;
    if (inlet) add(name, b.velocity);
    if (inlet && b.mean_speed) add(name, {*b.mean_speed});
    if (inlet && b.flow_rate) add(name, {*b.flow_rate});
    if (gives_pressure(b)) add(name, {b.pressure});
  }
  if (p.motion) {
    add("", p.motion->translation);
    add("", p.motion->displacement);
    add("", {p.motion->angle});
  }
  return rate;
}

std::vector<diagnostics::EffectChoice> choose_effects(const FluidParameters& p, const mesh::MeshFacts& mesh,
                                                      const diagnostics::CaseScene& scene) {
  const double speed = speed_of(p, mesh, scene.end_time);
  return {
      {"dimension", std::to_string(mesh.dim), std::to_string(mesh.dim),
       mesh.dim == 2 ? "the mesh has two-dimensional cells only" : "the mesh has three-dimensional cells"},
      turbulence(p, mesh, speed),
      viscous(p, mesh, speed),
      choose_waves(p, mesh, scene),
      mesh_motion(p, scene)};
}

}  // namespace couplet::fluid
