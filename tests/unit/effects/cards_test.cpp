// SPDX-License-Identifier: Apache-2.0
#include "common/diagnostics/diagnostics.hpp"
#include "common/effects/effects.hpp"
#include "coupler/parameters/effect_cards.hpp"
#include "coupler/parameters/schedule.hpp"
#include "fluid_solver/diagnostics/compliance.hpp"
#include "fluid_solver/parameters/effect_cards.hpp"
#include "plate_modal/effect_cards.hpp"
#include "solid_solver/diagnostics/effects.hpp"
#include "solid_solver/effects/effect_cards.hpp"
#include "tests/support/test.hpp"
#include "thermocline/judge/effects.hpp"

namespace couplet::testing::cards_test {
using namespace effects;
using namespace coupler;
using namespace solid;

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

/// The finding with this id, or nothing.
std::optional<log::Finding> with_id(const std::string& id, const std::vector<log::Finding>& findings) {
  for (const log::Finding& f : findings)
    if (f.id == id) return f;
  return {};
}

/// Tells whether there is such a finding and it is sound.
bool is_sound(const std::string& id, const std::vector<log::Finding>& findings) {
  const auto found = with_id(id, findings);
  EXPECT_TRUE(found.has_value()) << id;
  return found && found->severity == base::Severity::note;
}

/// Gives the model's part of the error that findings add up to.
coupling::ErrorParts model_of(const std::vector<log::Finding>& findings) {
  coupling::ErrorParts parts;
  diagnostics::add_model(findings, parts);
  return parts;
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
  for (const Effect& e : effects_of("solid_solver", solid_effect_cards(), p))
    if (e.on()) on.push_back(e.name);
  EXPECT_THAT(on, ElementsAre("gravity", "third dimension"));
  p.analysis = SolidParameters::Analysis::dynamic;
  EXPECT_THAT(summary(effects_of("solid_solver", solid_effect_cards(), p)),
              HasSubstr("inertia (analysis: dynamic)"));
}

TEST(EffectCards, without_evidence_there_is_no_verdict) {
  SolidParameters p = static_solid();
  for (const log::Finding& f : effect_findings(p, SolidEvidence{})) EXPECT_EQ(f.id, "near-incompressibility");
}

// Each share is what a closed form says of the answer.
TEST(EffectCards, neglected_effects_say_what_share_of_the_answer_they_change) {
  const SolidParameters p = static_solid();
  const auto model = [&](const SolidEvidence& e) { return model_of(effect_findings(p, e)); };
  EXPECT_DOUBLE_EQ(model({.inertia_over_load = 0.04}).model, 0.04);
  EXPECT_DOUBLE_EQ(model({.inertia_over_load = 430}).model, 1);
  const coupling::ErrorParts hot = model({.largest_gradient = 1e-6, .temperature_range = 75});
  EXPECT_NEAR(hot.model, 750, 1e-9);
  EXPECT_EQ(hot.model_by, "thermal strain neglected: use 'thermal-expansion'");
  // The elastica: a cantilever with P L^2 / (E I) = 1 has a slope of 0.46 at its tip, which moves 9.5 % less than the linear one.
  EXPECT_NEAR(model({.largest_gradient = 0.46 * std::sqrt(2.)}).model, 0.095, 0.02);
  EXPECT_DOUBLE_EQ(model({.largest_gradient = 1e-4, .buckling_factor = 1.5}).model, 2);
  EXPECT_DOUBLE_EQ(model({.largest_gradient = 1e-4, .buckling_factor = 0}).model, 10);
  EXPECT_TRUE(std::isnan(model_of(effect_findings(p, SolidEvidence{})).model));
}

TEST(EffectCards, what_does_next_to_nothing_could_be_omitted) {
  SolidParameters p = static_solid();
  p.analysis = SolidParameters::Analysis::dynamic;
  const auto idle = [&](double energies) {
    return model_of(effect_findings(p, SolidEvidence{.kinetic_over_strain = energies, .dynamic_steps = 100}))
        .omittable;
  };
  EXPECT_THAT(idle(5e-4), HasSubstr("inertia (max kinetic / largest strain energy = 0.0005"));
  EXPECT_THAT(idle(5e-4), HasSubstr("saves about 99 % of the time"));
  EXPECT_THAT(idle(5e-3), IsEmpty());
}

// Each pair lies just inside and just outside of validity.
TEST(EffectCards, solid_verdicts_turn_at_their_thresholds) {
  const SolidParameters p = static_solid();
  const auto sound = [&](const char* effect, const SolidEvidence& e, const SolidParameters& scene) {
    return is_sound(effect, effect_findings(scene, e));
  };
  EXPECT_TRUE(sound("inertia", {.inertia_over_load = 0.0099}, p));
  EXPECT_FALSE(sound("inertia", {.inertia_over_load = 0.0101}, p));
  EXPECT_TRUE(sound("geometric-non-linearity", {.largest_gradient = 0.0199}, p));
  EXPECT_FALSE(sound("geometric-non-linearity", {.largest_gradient = 0.0201}, p));
  EXPECT_TRUE(sound("thermal-strain", {.largest_gradient = 0.01, .temperature_range = 19}, p));
  EXPECT_FALSE(sound("thermal-strain", {.largest_gradient = 0.01, .temperature_range = 21}, p));
  // With a coefficient of its own, from the reference temperature on; without one a uniform temperature may be that of no stress.
  SolidParameters warm = p;
  warm.material.heat.expansion = config::ExpressionText{"2e-5"};
  EXPECT_TRUE(sound("thermal-strain",
                    {.largest_gradient = 0.01, .temperature_range = 0, .temperature_change = 9}, warm));
  EXPECT_FALSE(sound("thermal-strain",
                     {.largest_gradient = 0.01, .temperature_range = 0, .temperature_change = 11}, warm));
  EXPECT_TRUE(sound("thermal-strain",
                    {.largest_gradient = 0.01, .temperature_range = 0, .temperature_change = 400}, p));
  warm.material.heat.expansion = config::ExpressionText{"1e-7"};
  EXPECT_TRUE(sound("thermal-strain",
                    {.largest_gradient = 0.01, .temperature_range = 400, .temperature_change = 400}, warm));
  EXPECT_TRUE(sound("thermoelastic-coupling", {.coupling_number = 0.049}, p));
  EXPECT_FALSE(sound("thermoelastic-coupling", {.coupling_number = 0.051}, p));
  EXPECT_TRUE(sound("yielding", {.share_of_yield = 0.99}, p));
  EXPECT_FALSE(sound("yielding", {.share_of_yield = 1.01}, p));
  SolidParameters rubber = p;
  rubber.method.face_gradient = MethodParameters::FaceGradient::corrected;
  rubber.material.poissons_ratio = 0.451;
  EXPECT_FALSE(sound("near-incompressibility", {}, rubber));
  rubber.material.poissons_ratio = 0.449;
  EXPECT_TRUE(sound("near-incompressibility", {}, rubber));
  rubber.method.face_gradient = MethodParameters::FaceGradient::automatic;  // takes one volume strain a cell
  rubber.material.poissons_ratio = 0.451;
  EXPECT_FALSE(with_id("near-incompressibility", effect_findings(rubber, SolidEvidence{})));
}

TEST(EffectCards, an_effect_that_is_on_is_not_judged_as_left_out) {
  SolidParameters p = static_solid();
  p.analysis = SolidParameters::Analysis::dynamic;
  EXPECT_FALSE(with_id("inertia", effect_findings(p, SolidEvidence{.inertia_over_load = 1})));
}

TEST(Sound, is_that_of_a_key_a_pressure_a_substance_or_none) {
  using fluid::CompressibilityParameters;
  const auto speed = [](const CompressibilityParameters& p, double rho, double mu) {
    const auto sound = fluid::sound_of(p, rho, mu);
    return sound ? sound->speed : 0;
  };
  CompressibilityParameters p;
  EXPECT_NEAR(speed(p, 1.204, 1.8e-5), 343, 2) << "air by its density";
  EXPECT_NEAR(speed(p, 998, 1e-3), 1482, 1) << "water";
  EXPECT_EQ(speed(p, 1, 1), 0) << "a model fluid";
  EXPECT_EQ(speed(p, 1, 1e-3), 0);
  p.substance = "sf6";
  EXPECT_NEAR(speed(p, 1, 1), 135, 1);
  p.temperature = 373.15;
  EXPECT_NEAR(speed(p, 1, 1), 152.5, 1);
  p = {};
  p.substance = "water";
  EXPECT_NEAR(speed(p, 998, 1e-3), 1482, 2);
  EXPECT_EQ(fluid::misfit_of(p, 998), "");
  EXPECT_THAT(fluid::misfit_of(p, 1.2), ::testing::HasSubstr("water has 998 kg/m^3"));
  p.temperature = 333.15;
  EXPECT_NEAR(speed(p, 983, 5e-4), 1551, 1) << "60 degC";
  p = {};
  p.substance = "air";
  EXPECT_EQ(fluid::misfit_of(p, 1.2), "");
  EXPECT_THAT(fluid::misfit_of(p, 998), ::testing::HasSubstr("would be at 840 bar"));
  p = {};
  p.pressure = 5e5;  // air at 5 bar and 20 degC
  EXPECT_NEAR(speed(p, 5.94, 1.8e-5), std::sqrt(1.3 * 5e5 / 5.94), 20);
  p.heat_capacity_ratio = 1.4;
  EXPECT_NEAR(speed(p, 5.94, 1.8e-5), 343.3, 0.5);
  p = {};
  p.speed_of_sound = 77;
  EXPECT_EQ(speed(p, 1.2, 1.8e-5), 77);
}

TEST(ComplianceWatch, finds_the_fluctuations_of_a_harmonic_motion) {
  fluid::ComplianceWatch watch;
  const double omega = 7, dt = 1e-3;
  for (int n = 0; n * dt < 10 * 2 * M_PI / omega; ++n) {
    const double t = n * dt, s = std::sin(omega * t);
    // Two faces of a plate, a mean deflection; the pressure at rest is no part of it.
    watch.add(dt, {1e-6 * (3 + s), -1e-6 * (3 + s)}, {.swept = 0, .pressure_volume = 5 + 0.2 * s});
  }
  const auto walls = watch.walls();
  EXPECT_NEAR(std::sqrt(walls.rate / walls.square), omega, 0.01 * omega);
  EXPECT_NEAR(0.5 * walls.size, 1e-6 / std::sqrt(2.0), 1e-8);
  EXPECT_NEAR(watch.totals().pressure_volume, 0.2 / std::sqrt(2.0), 2e-3);
  EXPECT_EQ(watch.totals().swept, 0);
}

TEST(ComplianceWatch, knows_nothing_of_walls_at_rest_and_of_the_first_step) {
  fluid::ComplianceWatch watch;
  watch.add(0.1, {0, 0}, {.pressure_volume = 1e9});
  EXPECT_EQ(watch.totals().pressure_volume, 0) << "the impulse of the start";
  for (int n = 0; n < 5; ++n) watch.add(0.1, {0, 0}, {});
  EXPECT_EQ(watch.walls().square, 0);
}

// `--effects` asks before a case is read: this dereferenced the fluid that is not there yet.
TEST(EffectCards, coupling_cards_answer_without_participants) {
  EXPECT_NO_THROW(effects_of("coupler", coupling_effect_cards(), CouplingParameters{}));
  EXPECT_THROW(schedule_of(CouplingParameters{}), std::bad_optional_access);
}

TEST(EffectCards, tank_verdicts_turn_at_their_thresholds) {
  thermocline::ElementParameters tank;
  tank.type = thermocline::ElementParameters::Type::tank;
  tank.tank.bed.shells = 1;
  const auto sound = [&](const char* effect, const thermocline::Evidence& e) {
    return is_sound(effect, thermocline::effect_findings(tank, e));
  };
  EXPECT_TRUE(sound("resolved-grains", {.largest_biot = 19.9}));
  EXPECT_FALSE(sound("resolved-grains", {.largest_biot = 20.1}));
  const thermocline::Evidence spread{.implicit_spread = 0.051, .implicit_step = 1};
  EXPECT_FALSE(with_id("implicit-advection", thermocline::effect_findings(tank, spread)))
      << "where it is off";
  tank.tank.bed.advection = thermocline::Advection::implicit;
  EXPECT_TRUE(sound("implicit-advection", {.implicit_spread = 0.049, .implicit_step = 1}));
  EXPECT_FALSE(sound("implicit-advection", spread));
  EXPECT_TRUE(
      sound("specific-heat-of-a-gas-by-its-temperature", {.capacity_error = 0.049, .mean_capacity = 1e3}));
  EXPECT_FALSE(
      sound("specific-heat-of-a-gas-by-its-temperature", {.capacity_error = 0.051, .mean_capacity = 1e3}));
  EXPECT_TRUE(sound("mixing-of-inverted-fluid", {.inversion = 9, .inverted_share = 0.049}));
  EXPECT_FALSE(sound("mixing-of-inverted-fluid", {.inversion = 11, .inverted_share = 0.051}));
  EXPECT_TRUE(sound("pressure-loss-of-the-bed", {.pumping_share = 0.019, .pressure_loss = 1e4}));
  EXPECT_FALSE(sound("pressure-loss-of-the-bed", {.pumping_share = 0.021, .pressure_loss = 1e6}));
  EXPECT_TRUE(sound("compressible-flow-of-a-gas", {.largest_mach = 0.29}));
  EXPECT_FALSE(sound("compressible-flow-of-a-gas", {.largest_mach = 0.31}));
  EXPECT_TRUE(sound("yielding-of-the-wall", {.share_of_yield = 0.99}));
  EXPECT_FALSE(sound("yielding-of-the-wall", {.share_of_yield = 1.01}));
  EXPECT_TRUE(sound("bending-of-the-wall", {.share_as_rings = 0.5, .share_with_bending = 0.599}));
  EXPECT_FALSE(sound("bending-of-the-wall", {.share_as_rings = 0.5, .share_with_bending = 0.601}));
  tank.tank.pump.emplace();
  EXPECT_TRUE(sound("work-of-pump-or-fan", {.driving_power = 0.99e6, .carried_heat = 1e7}));
  EXPECT_FALSE(sound("work-of-pump-or-fan", {.driving_power = 4e7, .carried_heat = 2.8e7}));
  tank.tank.bed.shells = 5;
  EXPECT_FALSE(with_id("resolved-grains",
                       thermocline::effect_findings(tank, thermocline::Evidence{.largest_biot = 1e3})));
}

}  // namespace couplet::testing::cards_test
