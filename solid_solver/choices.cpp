// SPDX-License-Identifier: Apache-2.0
#include "solid_solver/choices.hpp"

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
      fmt::format("the loads change within {:.3g} s, and the longest natural period is about {:.3g} s",
                  change, period));
}

}  // namespace

std::vector<diagnostics::EffectChoice> choose_effects(const SolidParameters& p, const mesh::MeshFacts& mesh,
                                                      const diagnostics::CaseScene& scene) {
  std::vector<diagnostics::EffectChoice> choices{
      {"dimension", std::to_string(mesh.dim), std::to_string(mesh.dim),
       mesh.dim == 2 ? "the mesh has two-dimensional cells only" : "the mesh has three-dimensional cells",
       false}};
  if (p.analysis != SolidParameters::Analysis::thermal) choices.push_back(inertia(p, mesh, scene));
  return choices;
}

}  // namespace couplet::solid
