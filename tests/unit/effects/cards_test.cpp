// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/effects/card.hpp"
#include "fluid_solver/effect_cards.hpp"
#include "solid_solver/effect_cards.hpp"

namespace couplet::testing {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

/// The verdict on one effect, or nothing.
template <class Cards, class Scene, class Evidence>
std::optional<EffectVerdict> verdict_on(const std::string& effect, Cards cards, const Scene& scene,
                                        const Evidence& evidence) {
  for (const EffectVerdict& v : audit(cards, scene, evidence))
    if (v.effect == effect) return v;
  return {};
}

SolidParameters static_solid() {
  SolidParameters p;
  p.analysis = SolidParameters::Analysis::static_;
  p.material = {.density = 1000, .youngs_modulus = 1e9, .poissons_ratio = 0.3};
  return p;
}

TEST(EffectCards, a_scene_has_the_effects_that_it_asks_for_and_no_others) {
  SolidParameters p = static_solid();
  p.gravity = {0, 0, -9.81};
  std::vector<std::string> on;
  for (const Effect& e : effects_of(solid_effect_cards(), p))
    if (e.on()) on.push_back(e.name);
  EXPECT_THAT(on, ElementsAre("gravity", "third dimension"));
  p.analysis = SolidParameters::Analysis::dynamic;
  EXPECT_THAT(summary(effects_of(solid_effect_cards(), p)), HasSubstr("inertia (analysis: dynamic)"));
}

TEST(EffectCards, without_evidence_there_is_no_verdict) {
  SolidParameters p = static_solid();
  for (const EffectVerdict& v : audit(solid_effect_cards(), p, SolidEvidence{}))
    EXPECT_EQ(v.effect, "near incompressibility");
  EXPECT_THAT(audit(fluid::fluid_effect_cards(), fluid::FluidScene{}, fluid::FluidEvidence{}), IsEmpty());
}

// Each pair lies just inside and just outside of validity.
TEST(EffectCards, solid_verdicts_turn_at_their_thresholds) {
  const SolidParameters p = static_solid();
  const auto sound = [&](const char* effect, const SolidEvidence& e, const SolidParameters& scene) {
    const auto v = verdict_on(effect, solid_effect_cards(), scene, e);
    EXPECT_TRUE(v.has_value()) << effect;
    return v && v->sound();
  };
  EXPECT_TRUE(sound("inertia", {.inertia_over_load = 0.0099}, p));
  EXPECT_FALSE(sound("inertia", {.inertia_over_load = 0.0101}, p));
  EXPECT_TRUE(sound("geometric non-linearity", {.largest_gradient = 0.0199}, p));
  EXPECT_FALSE(sound("geometric non-linearity", {.largest_gradient = 0.0201}, p));
  EXPECT_TRUE(sound("thermal strain", {.largest_gradient = 0.01, .temperature_range = 19}, p));
  EXPECT_FALSE(sound("thermal strain", {.largest_gradient = 0.01, .temperature_range = 21}, p));
  EXPECT_TRUE(sound("thermoelastic coupling", {.coupling_number = 0.049}, p));
  EXPECT_FALSE(sound("thermoelastic coupling", {.coupling_number = 0.051}, p));
  SolidParameters rubber = p;
  rubber.method.face_gradient = MethodParameters::FaceGradient::corrected;
  rubber.material.poissons_ratio = 0.451;
  EXPECT_FALSE(sound("near incompressibility", {}, rubber));
  rubber.material.poissons_ratio = 0.449;
  EXPECT_TRUE(sound("near incompressibility", {}, rubber));
  rubber.method.face_gradient = MethodParameters::FaceGradient::automatic;  // takes one volume strain a cell
  rubber.material.poissons_ratio = 0.451;
  EXPECT_FALSE(
      verdict_on("near incompressibility", solid_effect_cards(), rubber, SolidEvidence{}).has_value());
}

TEST(EffectCards, an_effect_that_is_on_is_not_judged_as_left_out) {
  SolidParameters p = static_solid();
  p.analysis = SolidParameters::Analysis::dynamic;
  EXPECT_FALSE(verdict_on("inertia", solid_effect_cards(), p, SolidEvidence{.inertia_over_load = 1}));
}

TEST(EffectCards, fluid_verdicts_turn_at_their_thresholds) {
  fluid::FluidScene air, model;
  air.parameters.density = 1.2;
  model.parameters.turbulence.emplace();
  const auto sound = [&](const char* effect, const fluid::FluidEvidence& e, const fluid::FluidScene& scene) {
    const auto v = verdict_on(effect, fluid::fluid_effect_cards(), scene, e);
    EXPECT_TRUE(v.has_value()) << effect;
    return v && v->sound();
  };
  EXPECT_TRUE(sound("turbulence model", {.largest_peclet = 49}, air));
  EXPECT_FALSE(sound("turbulence model", {.largest_peclet = 51}, air));
  EXPECT_TRUE(sound("resolved walls", {.largest_yplus = 1.9}, model));
  EXPECT_FALSE(sound("resolved walls", {.largest_yplus = 2.1}, model));
  EXPECT_TRUE(sound("compressibility", {.largest_speed = 102}, air));
  EXPECT_FALSE(sound("compressibility", {.largest_speed = 104}, air));
  EXPECT_FALSE(verdict_on("turbulence model", fluid::fluid_effect_cards(), model,
                          fluid::FluidEvidence{.largest_peclet = 1e4}));
}

TEST(EffectCards, a_verdict_says_number_threshold_and_cure) {
  const EffectVerdict bad{"inertia", 0.3, 0.01, "it would have reached 0.3 of the load",
                          "use 'analysis: dynamic'"};
  EXPECT_EQ(
      text(bad),
      "inertia left out: it would have reached 0.3 of the load (sound up to 0.01); use 'analysis: dynamic'.");
  const EffectVerdict good{"inertia", 0.003, 0.01, "it would have reached 0.003 of the load", ""};
  EXPECT_THAT(text(good), HasSubstr("; leaving it out was sound."));
  EXPECT_FALSE((EffectVerdict{"x", std::nan(""), 1, "", ""}.sound()));
}

TEST(AuditTrail, tells_bad_news_once) {
  AuditTrail trail;
  EffectVerdict v{"inertia", 0.003, 0.01, "", ""};
  EXPECT_THAT(trail.news({v}), IsEmpty());
  EXPECT_TRUE(trail.all_sound());
  v.number = 0.02;
  EXPECT_EQ(trail.news({v}).size(), 1u);
  EXPECT_THAT(trail.news({v}), IsEmpty());
  EXPECT_THAT(trail.unsound(), ElementsAre("inertia"));
}

}  // namespace
}  // namespace couplet::testing
