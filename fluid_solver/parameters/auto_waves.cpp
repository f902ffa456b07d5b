// SPDX-License-Identifier: Apache-2.0
// Whether `effects: auto` computes pressure waves.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "common/fv/expression.hpp"
#include "fluid_solver/parameters/auto_effects.hpp"

namespace couplet::fluid {
namespace {

constexpr double slow = 0.3;  // of the audit: travel time of sound over 1/omega
constexpr int most_samples = 2000, places = 4;

/// Root mean square rate of what is prescribed over its root mean square about the mean [1/s]; 0: it does not change.
double rate_of(const config::ExpressionText& text, const Vec3& at, const effects::ChoiceScene& scene) {
  const fv::Expression value(text, "what is prescribed");
  const int n = std::clamp(int(scene.end_time / std::max(scene.time_step, 1e-300)), 2, most_samples);
  const double dt = std::min(scene.time_step, scene.end_time / n);
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

/// The fastest of all that is prescribed.
double largest_rate(const FluidParameters& p, const mesh::MeshFacts& mesh,
                    const effects::ChoiceScene& scene) {
  std::vector<config::ExpressionText> texts;
  const auto add = [&texts](const auto& more) { texts.insert(texts.end(), more.begin(), more.end()); };
  for (const auto& [name, b] : p.boundaries) {
    const bool inlet = condition_of(b).passage == Passage::in;
    if (inlet) add(b.velocity);
    if (inlet && b.mean_speed) texts.push_back(*b.mean_speed);
    if (gives_pressure(b)) texts.push_back(b.pressure);
  }
  if (p.motion) {
    add(p.motion->translation);
    add(p.motion->displacement);
    texts.push_back(p.motion->angle);
  }
  double rate = 0;
  for (const auto& text : texts)
    for (int i = 0; i <= places; ++i)
      rate = std::max(rate, rate_of(text, double(i) / places * mesh.size, scene));
  return rate;
}

}  // namespace

effects::EffectChoice choose_waves(const FluidParameters& p, const mesh::MeshFacts& mesh,
                                   const effects::ChoiceScene& scene) {
  const auto without = [](std::string reason) {
    return effects::EffectChoice{"compressibility", "", "none, incompressible", std::move(reason), false};
  };
  const auto with = [](std::string reason) {
    return effects::EffectChoice{"compressibility", "{scheme: three-level}", "three-level", std::move(reason),
                                 false};
  };
  const auto has = [&p](const auto& fact) {
    return std::ranges::any_of(p.boundaries, [&](const auto& b) { return fact(b.second); });
  };
  const auto velocity_by = [&has](GivenBy who) {
    return has([who](const BoundaryParameters& b) { return condition_of(b).velocity == who; });
  };
  const auto sound = sound_of({}, p.density, p.viscosity);
  if (!sound) return without("a model fluid, whose sound is not known");
  if (!p.bodies.empty() || p.rotating_frame || p.scheme == ExplicitScheme::runge_kutta ||
      velocity_by(GivenBy::flow))
    return without("not available with another of the case's keys");
  if (!p.gaps.empty() && has([](const auto& b) { return condition_of(b).passage == Passage::in; }))
    return with("what flows into a part that 'gaps' shut off compresses it");
  if (scene.coupled && p.volume_level == VolumeLevelBy::nobody && velocity_by(GivenBy::structure) &&
      !has(gives_pressure))
    return with("no outlet: an interface that moves compresses the fluid");
  const double rate = largest_rate(p, mesh, scene), phase = rate * mesh.largest_side() / sound->speed;
  const std::string reason =
      fmt::format("sound crosses {} in {:.2g} s = {:.2g} of 1/omega of what is prescribed", sound->of,
                  mesh.largest_side() / sound->speed, phase);
  if (phase > slow) return with(reason);
  return without(scene.coupled && velocity_by(GivenBy::structure)
                     ? reason + "; the run reports if the compliance or the waves matter to the interface"
                     : reason);
}

}  // namespace couplet::fluid
